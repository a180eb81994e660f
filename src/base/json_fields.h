// Parts of JSON files: checked reading of our own files, and values that several files hold.
#pragma once

#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>

#include "base/json.h"
#include "base/statistics.h"

namespace vpr {

/// Reads the fields of one JSON object; anything unexpected is an error. `message` is the format of
/// the error from `where` and the damage, a constant.
class Fields {
 public:
  Fields(const Json& json, std::string where,
         std::string_view message = "{}: is damaged: {}. Run the command that wrote it again")
      : json_(json), where_(std::move(where)), message_(message) {
    if (!json.is_object()) fail("a part is not an object");
  }
  const Json& operator[](const std::string& key) const {
    const auto found = json_.find(key);
    if (found == json_.end()) fail(fmt::format("\"{}\" is missing", key));
    return *found;
  }
  bool has(const std::string& key) const { return json_.contains(key); }
  uint64_t count(const std::string& key, uint64_t most) const {
    const Json& value = (*this)[key];
    if (!value.is_number_unsigned() || value.get<uint64_t>() > most)
      fail(fmt::format("\"{}\" is not a number in range", key));
    return value.get<uint64_t>();
  }
  std::string text(const std::string& key) const {
    const Json& value = (*this)[key];
    if (!value.is_string()) fail(fmt::format("\"{}\" is not a string", key));
    return value.get<std::string>();
  }
  const Json& list(const std::string& key) const {
    const Json& value = (*this)[key];
    if (!value.is_array()) fail(fmt::format("\"{}\" is not a list", key));
    return value;
  }
  Fields object(const std::string& key) const { return part((*this)[key]); }
  /// The fields of an object within this one.
  Fields part(const Json& json) const { return {json, where_, message_}; }
  const Json& json() const { return json_; }
  const std::string& where() const { return where_; }
  [[noreturn]] void fail(std::string_view what) const {
    throw Error(ErrorKind::data, fmt::format(fmt::runtime(message_), where_, what));
  }

 private:
  const Json& json_;
  std::string where_;
  std::string_view message_;
};

/// "fps": frames per second.
inline double read_fps(const Fields& fields) {
  const Json& json = fields["fps"];
  if (!json.is_number()) fields.fail("\"fps\" is not a number");
  const auto fps = json.get<double>();
  if (!(fps > 0 && std::isfinite(fps))) fields.fail("\"fps\" is out of range");
  return fps;
}

template <class T>
inline constexpr bool kIsNumbered = false;
template <class T>
inline constexpr bool kIsNumbered<std::map<size_t, T>> = true;

/// A field of visit_fields with its own functions that write and read it under its key.
template <class T>
concept OwnForm = requires(T field, Json& json, const Fields& fields, const std::string& key) {
  field.write(json, key);
  field.read(fields, key);
};

/// A struct as JSON, by its visit_fields. Infinity and NaN become null.
template <class T>
Json fields_to_json(const T& value) {
  if constexpr (Settings<T>) {
    Json json = Json::object();
    visit_fields(const_cast<T&>(value), [&](std::string_view name, auto&& field) {  // not changed
      const std::string key(name);
      if constexpr (OwnForm<decltype(field)>)
        field.write(json, key);
      else
        json[key] = fields_to_json(field);
    });
    return json;
  } else if constexpr (detail::kIsOptional<T>) {
    return value ? fields_to_json(*value) : Json();
  } else if constexpr (detail::kIsList<T>) {
    Json json = Json::array();
    for (const auto& item : value) json.push_back(fields_to_json(item));
    return json;
  } else if constexpr (kIsNumbered<T>) {
    Json json = Json::object();
    for (const auto& [number, item] : value) json[std::to_string(number)] = fields_to_json(item);
    return json;
  } else if constexpr (std::is_floating_point_v<T>) {
    return std::isfinite(value) ? Json(value) : Json();
  } else {
    return value_to_json(value);
  }
}

/// Reads what fields_to_json wrote; null for a number is infinity. Throws Error(data) for anything
/// unexpected: `fields` names the file, and `key` the part.
template <class T>
void fields_from_json(const Json& json, T& value, const Fields& fields, const std::string& key) {
  if constexpr (Settings<T>) {
    const Fields part = fields.part(json);
    visit_fields(value, [&](std::string_view name, auto&& field) {
      const std::string inner(name);
      if constexpr (OwnForm<decltype(field)>)
        field.read(part, inner);
      else
        fields_from_json(part[inner], field, part, inner);
    });
  } else if constexpr (detail::kIsOptional<T>) {
    if (!json.is_null()) fields_from_json(json, value.emplace(), fields, key);
  } else if constexpr (detail::kIsList<T>) {
    if (!json.is_array()) fields.fail(fmt::format("\"{}\" is not a list", key));
    for (const Json& item : json) fields_from_json(item, value.emplace_back(), fields, key);
  } else if constexpr (kIsNumbered<T>) {
    const Fields part = fields.part(json);
    for (const auto& item : json.items()) {
      size_t number = 0;
      const char* end = item.key().data() + item.key().size();
      const auto [stop, error] = std::from_chars(item.key().data(), end, number);
      if (error != std::errc{} || stop != end)
        part.fail(fmt::format("\"{}\" is not a number", item.key()));
      fields_from_json(item.value(), value[number], part, item.key());
    }
  } else {
    if constexpr (std::is_floating_point_v<T>)
      if (json.is_null()) {
        value = std::numeric_limits<T>::infinity();
        return;
      }
    try {
      value_from_json(json, value, fields.where(), key);
    } catch (const Error& error) {
      throw Error(ErrorKind::data, error.what());
    }
  }
}

/// A field that is omitted if it has no value. (An optional without a value is otherwise null.)
template <class T>
struct IfSet {
  std::optional<T>& field;

  void write(Json& json, const std::string& key) const {
    if (field) json[key] = fields_to_json(*field);
  }
  void read(const Fields& fields, const std::string& key) {
    if (fields.has(key)) fields_from_json(fields[key], field.emplace(), fields, key);
  }
};
template <class T>
IfSet(std::optional<T>&) -> IfSet<T>;

/// A field that is omitted if it has its usual value.
template <class T>
struct Unless {
  T& field;
  T usual;

  void write(Json& json, const std::string& key) const {
    if (field != usual) json[key] = fields_to_json(field);
  }
  void read(const Fields& fields, const std::string& key) {
    if (fields.has(key)) fields_from_json(fields[key], field, fields, key);
  }
};
template <class T>
Unless(T&, T) -> Unless<T>;

/// A field computed from the others: it is not read.
template <class T>
struct Derived {
  T value;

  void write(Json& json, const std::string& key) const { json[key] = fields_to_json(value); }
  void read(const Fields&, const std::string&) {}
};
template <class T>
Derived(T) -> Derived<T>;

/// The value of an optional, or null.
Json or_null(const auto& value) { return value ? Json(*value) : Json(); }

inline Json interval_json(const Interval& interval) { return {interval.low, interval.high}; }

}  // namespace vpr
