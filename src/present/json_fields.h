// Parts of JSON files: checked reading of our own files, and values that several files hold.
#pragma once

#include <cmath>
#include <string>
#include <string_view>

#include "base/json.h"
#include "base/statistics.h"

namespace vpr {

/// Reads the fields of one JSON object; anything unexpected is damage.
class Fields {
 public:
  Fields(const Json& json, const std::string& where) : json_(json), where_(where) {
    if (!json.is_object()) fail("a part is no object");
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
      fail(fmt::format("\"{}\" is no number in range", key));
    return value.get<uint64_t>();
  }
  std::string text(const std::string& key) const {
    const Json& value = (*this)[key];
    if (!value.is_string()) fail(fmt::format("\"{}\" is no text", key));
    return value.get<std::string>();
  }
  const Json& list(const std::string& key) const {
    const Json& value = (*this)[key];
    if (!value.is_array()) fail(fmt::format("\"{}\" is no list", key));
    return value;
  }
  Fields object(const std::string& key) const { return {(*this)[key], where_}; }
  [[noreturn]] void fail(std::string_view what) const {
    throw Error(ErrorKind::data, fmt::format("{}: is damaged: {}; make it again", where_, what));
  }

 private:
  const Json& json_;
  const std::string& where_;
};

/// "fps": frames a second.
inline double read_fps(const Fields& fields) {
  const Json& json = fields["fps"];
  if (!json.is_number()) fields.fail("\"fps\" is no number");
  const auto fps = json.get<double>();
  if (!(fps > 0 && std::isfinite(fps))) fields.fail("\"fps\" is out of range");
  return fps;
}

/// The value of an optional, or null.
Json or_null(const auto& value) { return value ? Json(*value) : Json(); }

inline Json interval_json(const Interval& interval) { return {interval.low, interval.high}; }

}  // namespace vpr
