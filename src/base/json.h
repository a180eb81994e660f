// Conversion between JSON text, structs and JSON values.
//
// A struct S is described once, by a function that argument-dependent lookup finds:
//   template <class Visitor> void visit_fields(S& s, Visitor&& v) {
//     v("c_l", s.window_length, "Window length in frames.", at_least(1));
//   }
// It provides the JSON object, checked reading, the hint with the nearest key, and the schema
// (base/json_schema.h), which has the description and the bounds. Settings with flags may have
// their description in a SettingRow instead. A JsonForm says what differs between settings that
// people write and data in our own files.
#pragma once

#include <array>
#include <cmath>
#include <filesystem>
#include <map>
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

/// Returns nullopt for invalid JSON, for an object with a key that occurs twice, and for JSON
/// nested deeper than any of our files, so that code that uses the value may recurse.
std::optional<Json> parse_json(std::string_view text);

/// Reads a whole file. Throws Error(input) if it cannot be read, Error(kind) if it is not JSON.
Json read_json(const std::filesystem::path& path, ErrorKind kind);

/// "vpr.<kind>/5" for results, reports and what is made from them, "vpr.<kind>/3" for other files.
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
inline constexpr bool kIsArray = false;
template <class T, size_t N>
inline constexpr bool kIsArray<std::array<T, N>> = true;
template <class T>
inline constexpr bool kIsOptional = false;
template <class T>
inline constexpr bool kIsOptional<std::optional<T>> = true;
template <class T>
inline constexpr bool kIsMap = false;
template <class Key, class T>
inline constexpr bool kIsMap<std::map<Key, T>> = true;
template <class Key, class T>
inline constexpr bool kIsMap<nlohmann::ordered_map<Key, T>> = true;

/// A visitor that accepts any field; it distinguishes structs with fields from other types.
struct AnyVisitor {
  template <class T>
  void operator()(std::string_view, T&, const auto&...) const {}
};

/// "one of a, b".
std::string one_of(std::span<const std::string_view> names);
}  // namespace detail

/// How a family of files stores structs, and how its defects are reported.
struct JsonForm {
  std::string_view absent;  ///< an optional without a value; empty: null
  /// Reading: missing keys leave their fields unchanged, and unknown keys are errors. false: every
  /// key is required, other keys are skipped, and null for a number is infinity.
  bool is_partial = false;
  ErrorKind error = ErrorKind::data;
  std::string_view message;  ///< format of errors, from the name of the file and the defect
};

/// Settings that people write.
inline constexpr JsonForm kSettingsForm = {"auto", true, ErrorKind::usage, "{}: {}"};
/// Settings in our own files.
inline constexpr JsonForm kStoredSettingsForm = {"auto", true, ErrorKind::data, "{}: {}"};
/// Other data in our own files.
inline constexpr JsonForm kDataForm = {"", false, ErrorKind::data,
                                       "{}: is damaged: {}. Run the command that wrote it again"};

/// The file of a JSON value.
struct JsonSource {
  std::string where;  ///< its name
  JsonForm form = kDataForm;

  [[noreturn]] void fail(std::string_view defect) const;
  [[noreturn]] void refuse(const std::string& key, std::string_view expected,
                           const Json& found) const;
  /// Throws with the nearest name for a key of `json` that is not among the known ones.
  void refuse_unknown(const Json& json, const std::vector<std::string>& known) const;
};

/// A struct with a visit_fields function.
template <class S>
concept Settings = requires(S& s, detail::AnyVisitor v) {
  visit_fields(s, v);
};

/// Reads the fields of one JSON object, which must outlive it; anything unexpected is an error.
class Fields {
 public:
  Fields(const Json& json, JsonSource source, const std::string& key = "the file");
  Fields(const Json& json, std::string where) : Fields(json, JsonSource{std::move(where)}) {}

  const Json& operator[](const std::string& key) const;
  bool has(const std::string& key) const { return json_.contains(key); }
  uint64_t count(const std::string& key, uint64_t most) const;
  std::string text(const std::string& key) const;
  const Json& list(const std::string& key) const;
  Fields object(const std::string& key) const { return {(*this)[key], source_, key}; }
  template <class T>
  void read(const std::string& key, T& value) const;
  /// An optional that is unset if the key is missing.
  template <class T>
  void read_if_set(const std::string& key, std::optional<T>& value) const {
    if (has(key)) read(key, value.emplace());
  }
  /// Settings in one of our own files.
  template <Settings S>
  void read_settings(const std::string& key, S& settings) const;

  const Json& json() const { return json_; }
  const JsonSource& source() const { return source_; }
  const std::string& where() const { return source_.where; }
  [[noreturn]] void fail(std::string_view defect) const { source_.fail(defect); }

 private:
  const Json& json_;
  JsonSource source_;
};

/// A field of visit_fields with its own functions that write and read it under its key.
template <class T>
concept HasOwnFormat = requires(T field, Json& json, const JsonForm& form, const Fields& fields,
                                const std::string& key) {
  field.write(json, key, form);
  field.read(fields, key);
};

/// A value as stored in files: a struct becomes an object with all its keys in the order of
/// visit_fields, and an enumerator its name. Infinity and NaN become null.
template <class T>
Json value_to_json(const T& value, const JsonForm& form = kSettingsForm) {
  if constexpr (Settings<T>) {
    Json json = Json::object();
    // The value is not changed.
    visit_fields(const_cast<T&>(value), [&](std::string_view name, auto&& field, const auto&...) {
      const std::string key(name);
      if constexpr (HasOwnFormat<decltype(field)>)
        field.write(json, key, form);
      else
        json[key] = value_to_json(field, form);
    });
    return json;
  } else if constexpr (detail::kIsOptional<T>) {
    if (value) return value_to_json(*value, form);
    return form.absent.empty() ? Json() : Json(form.absent);
  } else if constexpr (detail::kIsList<T> || detail::kIsArray<T>) {
    Json json = Json::array();
    for (const auto& item : value) json.push_back(value_to_json(item, form));
    return json;
  } else if constexpr (detail::kIsMap<T>) {
    Json json = Json::object();
    for (const auto& [key, item] : value) json[fmt::format("{}", key)] = value_to_json(item, form);
    return json;
  } else if constexpr (std::is_enum_v<T>) {
    return enum_name(value);
  } else if constexpr (std::is_floating_point_v<T>) {
    return std::isfinite(value) ? Json(value) : Json();
  } else {
    return value;
  }
}

namespace detail {
void read_value(const Json& json, bool& value, const JsonSource& source, const std::string& key);
void read_value(const Json& json, double& value, const JsonSource& source, const std::string& key);
void read_value(const Json& json, std::string& value, const JsonSource& source,
                const std::string& key);
void read_value(const Json& json, std::filesystem::path& value, const JsonSource& source,
                const std::string& key);
/// A key of an object as a number.
size_t number_of_key(const std::string& key, const JsonSource& source);

template <class T>
void read_struct(const Json& json, T& value, const JsonSource& source, const std::string& key);
}  // namespace detail

/// Reads what value_to_json wrote, or people, as the form of the source says.
template <class T>
void value_from_json(const Json& json, T& value, const JsonSource& source, const std::string& key) {
  if constexpr (Settings<T>) {
    detail::read_struct(json, value, source, key);
  } else if constexpr (detail::kIsOptional<T>) {
    const std::string_view absent = source.form.absent;
    if (absent.empty() ? json.is_null() : json == absent) {
      value = std::nullopt;
    } else if (!absent.empty() && std::is_arithmetic_v<typename T::value_type> &&
               !json.is_number()) {
      source.refuse(key, fmt::format("a number or \"{}\"", absent), json);
    } else {
      value_from_json(json, value.emplace(), source, key);
    }
  } else if constexpr (detail::kIsList<T>) {
    if (!json.is_array()) source.refuse(key, "a list", json);
    value.clear();
    for (const Json& item : json) value_from_json(item, value.emplace_back(), source, key);
  } else if constexpr (detail::kIsArray<T>) {
    if (!json.is_array() || json.size() != value.size())
      source.refuse(key, fmt::format("a list of {}", value.size()), json);
    for (size_t i = 0; i < value.size(); ++i) value_from_json(json[i], value[i], source, key);
  } else if constexpr (detail::kIsMap<T>) {
    if (!json.is_object()) source.refuse(key, "an object", json);
    for (const auto& [name, item] : json.items()) {
      if constexpr (std::is_same_v<typename T::key_type, std::string>)
        value_from_json(item, value[name], source, name);
      else
        value_from_json(item, value[detail::number_of_key(name, source)], source, name);
    }
  } else if constexpr (std::is_enum_v<T>) {
    const auto found = json.is_string() ? enum_value<T>(json.get<std::string>()) : std::nullopt;
    if (!found) source.refuse(key, detail::one_of(kEnumNames<T>), json);
    value = *found;
  } else if constexpr (std::is_integral_v<T> && !std::is_same_v<T, bool>) {
    if (!json.is_number_integer()) source.refuse(key, "an integer", json);
    const bool fits = json.is_number_unsigned() ? std::in_range<T>(json.get<uint64_t>())
                                                : std::in_range<T>(json.get<int64_t>());
    if (!fits) source.refuse(key, "an integer in range", json);
    value = json.get<T>();
  } else {
    detail::read_value(json, value, source, key);
  }
}

/// Reads settings that people write: `where` names the file. Throws Error(usage) for an unknown key
/// (with the nearest name) or a value of the wrong type.
template <class T>
void value_from_json(const Json& json, T& value, const std::string& where, const std::string& key) {
  value_from_json(json, value, JsonSource{where, kSettingsForm}, key);
}

template <class T>
void detail::read_struct(const Json& json, T& value, const JsonSource& source,
                         const std::string& key) {
  const Fields fields(json, source, key);
  std::vector<std::string> known;
  visit_fields(value, [&](std::string_view name, auto&& field, const auto&...) {
    const std::string& inner = known.emplace_back(name);
    if constexpr (HasOwnFormat<decltype(field)>)
      field.read(fields, inner);
    else if (!source.form.is_partial || fields.has(inner))
      value_from_json(fields[inner], field, source, inner);
  });
  if (source.form.is_partial) source.refuse_unknown(json, known);
}

template <class T>
void Fields::read(const std::string& key, T& value) const {
  value_from_json((*this)[key], value, source_, key);
}

template <Settings S>
void Fields::read_settings(const std::string& key, S& settings) const {
  value_from_json((*this)[key], settings, JsonSource{source_.where, kStoredSettingsForm}, key);
}

/// A field that is omitted if it has no value. (An optional without a value is otherwise null.)
template <class T>
struct IfSet {
  std::optional<T>& field;

  void write(Json& json, const std::string& key, const JsonForm& form) const {
    if (field) json[key] = value_to_json(*field, form);
  }
  void read(const Fields& fields, const std::string& key) const { fields.read_if_set(key, field); }
};
template <class T>
IfSet(std::optional<T>&) -> IfSet<T>;

/// A field that is omitted if it has its usual value.
template <class T>
struct Unless {
  T& field;
  T usual;

  void write(Json& json, const std::string& key, const JsonForm& form) const {
    if (field != usual) json[key] = value_to_json(field, form);
  }
  void read(const Fields& fields, const std::string& key) const {
    if (fields.has(key)) fields.read(key, field);
  }
};
template <class T>
Unless(T&, T) -> Unless<T>;

/// A field computed from the others: it is not read.
template <class T>
struct Derived {
  T value;

  void write(Json& json, const std::string& key, const JsonForm& form) const {
    json[key] = value_to_json(value, form);
  }
  void read(const Fields&, const std::string&) const {}
};
template <class T>
Derived(T) -> Derived<T>;

/// A field with its own functions.
template <class Write, class Read>
struct CustomField {
  Write write_field;
  Read read_field;

  void write(Json& json, const std::string& key, const JsonForm&) const { write_field(json, key); }
  void read(const Fields& fields, const std::string& key) const { read_field(fields, key); }
};
template <class Write, class Read>
CustomField(Write, Read) -> CustomField<Write, Read>;  // Clang 14 deduces none of aggregates

/// A field that is only read.
template <class Read>
struct ReadField {
  Read read_field;

  void write(Json&, const std::string&, const JsonForm&) const {}
  void read(const Fields& fields, const std::string& key) const { read_field(fields, key); }
};
template <class Read>
ReadField(Read) -> ReadField<Read>;

/// An object whose fields a function visits.
template <class Visit>
struct NestedObject {
  Visit visit;
};
template <class Visit>
NestedObject(Visit) -> NestedObject<Visit>;

template <class Visit, class Visitor>
void visit_fields(NestedObject<Visit>& object, Visitor&& visitor) {
  object.visit(visitor);
}

/// A list of objects whose fields `visit(item, visitor)` visits.
template <class T, class Visit>
struct NestedList {
  std::vector<T>& list;
  Visit visit;

  auto object_of(T& item) const {
    return NestedObject{[this, &item](auto&& visitor) { visit(item, visitor); }};
  }
  void write(Json& json, const std::string& key, const JsonForm& form) const {
    json[key] = Json::array();
    for (T& item : list) json[key].push_back(value_to_json(object_of(item), form));
  }
  void read(const Fields& fields, const std::string& key) const {
    if (fields.source().form.is_partial && !fields.has(key)) return;
    const JsonSource source{fields.where() + ", " + key, fields.source().form};
    for (const Json& json : fields.list(key)) {
      auto object = object_of(list.emplace_back());
      value_from_json(json, object, source, key);
    }
  }
};
template <class T, class Visit>
NestedList(std::vector<T>&, Visit) -> NestedList<T, Visit>;

/// A field that is omitted unless `is_present()`, which must hold once it has been read.
template <class Test, class T>
struct PresentIf {
  Test is_present;
  T field;

  void write(Json& json, const std::string& key, const JsonForm& form) const {
    if (is_present()) json[key] = value_to_json(field, form);
  }
  void read(const Fields& fields, const std::string& key) {
    if (!fields.has(key)) return;
    fields.read(key, field);
    if (!is_present()) fields.fail(fmt::format("\"{}\" is out of range", key));
  }
};
template <class Test, class T>
PresentIf(Test, T) -> PresentIf<Test, T>;

/// The value of an optional, or null.
Json or_null(const auto& value) { return value ? Json(*value) : Json(); }

}  // namespace vpr
