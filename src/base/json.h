// Conversion between JSON text, settings structs and JSON values.
//
// A settings struct S is described once, by a function that argument-dependent lookup finds:
//   template <class Visitor> void visit_fields(S& s, Visitor&& v) { v("c_l", s.window_length); }
// It provides the JSON object, the check for unknown keys and the hint with the nearest key.
#pragma once

#include <algorithm>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/enum_names.h"
#include "base/error.h"
#include "base/json_fwd.h"

namespace vpr {

/// Returns nullopt for invalid JSON, or for JSON nested deeper than any of our files, so that code
/// that uses the value may recurse.
std::optional<Json> parse_json(std::string_view text);

/// Reads a whole file. Throws Error(input) if it cannot be read, Error(kind) if it is not JSON.
Json read_json(const std::filesystem::path& path, ErrorKind kind);

/// "vpr.<kind>/4" for reports and what is made from them, "vpr.<kind>/3" for other files.
std::string schema_name(std::string_view kind);

/// Checks `"schema"` against schema_name. Otherwise throws Error(error_kind), which says whether
/// the kind or the version differs.
void require_schema(const Json& json, std::string_view schema_kind, const std::string& where,
                    ErrorKind error_kind);

/// Two spaces of indentation and a final line feed; invalid UTF-8 is replaced.
std::string to_text(const Json& json);

/// One line without spaces; invalid UTF-8 is replaced.
std::string to_line(const Json& json);

namespace detail {
template <class T>
inline constexpr bool kIsList = false;
template <class T>
inline constexpr bool kIsList<std::vector<T>> = true;
template <class T>
inline constexpr bool kIsOptional = false;
template <class T>
inline constexpr bool kIsOptional<std::optional<T>> = true;

/// A visitor that accepts any field; it distinguishes settings structs from other types.
struct AnyVisitor {
  template <class T>
  void operator()(const char*, T&) const {}
};

/// "one of ["a","b"]".
std::string one_of(std::span<const std::string_view> names);
[[noreturn]] void bad_value(const std::string& where, const std::string& key,
                            std::string_view expected, const Json& found);
[[noreturn]] void unknown_key(const std::string& where, const std::string& key,
                              const std::vector<std::string>& known);

}  // namespace detail

/// A struct with a visit_fields function.
template <class S>
concept Settings = requires(S& s, detail::AnyVisitor v) {
  visit_fields(s, v);
};

/// A setting as stored in files: a struct becomes an object with all its keys in the order of
/// visit_fields, an enumerator its name, and an empty optional "auto".
template <class T>
Json value_to_json(const T& value) {
  if constexpr (Settings<T>) {
    Json json = Json::object();
    visit_fields(const_cast<T&>(value),  // visited, not changed
                 [&](const char* key, auto& field) { json[key] = value_to_json(field); });
    return json;
  } else if constexpr (detail::kIsOptional<T>) {
    return value ? value_to_json(*value) : Json("auto");
  } else if constexpr (std::is_enum_v<T>) {
    return enum_name(value);
  } else {
    return value;
  }
}

/// Reads the keys that are present; the other fields keep their values. `where` names the file.
/// Throws Error(usage) for an unknown key (with the nearest name) or a value of the wrong type.
template <class T>
void value_from_json(const Json& json, T& value, const std::string& where, const std::string& key) {
  if constexpr (Settings<T>) {
    if (!json.is_object()) detail::bad_value(where, key, "an object", json);
    std::vector<std::string> known;
    visit_fields(value, [&](const char* name, auto& field) {
      known.emplace_back(name);
      const auto found = json.find(name);
      if (found != json.end()) value_from_json(*found, field, where, name);
    });
    for (const auto& item : json.items())
      if (std::find(known.begin(), known.end(), item.key()) == known.end())
        detail::unknown_key(where, item.key(), known);
  } else if constexpr (detail::kIsOptional<T>) {
    if (json == "auto") {
      value = std::nullopt;
    } else if (std::is_arithmetic_v<typename T::value_type> && !json.is_number()) {
      detail::bad_value(where, key, "a number or \"auto\"", json);
    } else {
      value_from_json(json, value.emplace(), where, key);
    }
  } else if constexpr (detail::kIsList<T>) {
    if (!json.is_array()) detail::bad_value(where, key, "a list", json);
    value.clear();
    for (const Json& item : json) value_from_json(item, value.emplace_back(), where, key);
  } else if constexpr (std::is_enum_v<T>) {
    const auto found = json.is_string() ? enum_value<T>(json.get<std::string>()) : std::nullopt;
    if (!found) detail::bad_value(where, key, detail::one_of(kEnumNames<T>), json);
    value = *found;
  } else if constexpr (std::is_same_v<T, bool>) {
    if (!json.is_boolean()) detail::bad_value(where, key, "true or false", json);
    value = json.get<bool>();
  } else if constexpr (std::is_integral_v<T>) {
    if (!json.is_number_integer()) detail::bad_value(where, key, "an integer", json);
    const bool fits = json.is_number_unsigned() ? std::in_range<T>(json.get<uint64_t>())
                                                : std::in_range<T>(json.get<int64_t>());
    if (!fits) detail::bad_value(where, key, "an integer in range", json);
    value = json.get<T>();
  } else if constexpr (std::is_floating_point_v<T>) {
    if (!json.is_number()) detail::bad_value(where, key, "a number", json);
    value = json.get<T>();
  } else {
    static_assert(std::is_same_v<T, std::string>);
    if (!json.is_string()) detail::bad_value(where, key, "a string", json);
    value = json.get<std::string>();
  }
}

/// Reads the settings stored in one of our files. Throws Error(data) for any defect.
template <Settings S>
void stored_settings_from_json(const Json& file, S& settings, const std::string& where) {
  const auto found = file.find("settings");
  if (found == file.end())
    throw Error(ErrorKind::data, fmt::format("{}: is damaged: it has no settings", where));
  try {
    value_from_json(*found, settings, where, "settings");
  } catch (const Error& error) {
    throw Error(ErrorKind::data, error.what());
  }
}

}  // namespace vpr
