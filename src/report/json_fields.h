// Reading JSON files of ours without trusting them.
#pragma once

#include <cmath>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/checksum.h"
#include "base/json.h"
#include "base/npy.h"

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

/// Opens an array that was written beside a JSON file; `entry` is its object there. Throws
/// Error(data) if it is not the one that the JSON was written with.
inline NpyArray read_companion(const std::filesystem::path& path, const Fields& entry) {
  NpyArray array(path);
  if (checksum(array.file_bytes()) != entry.text("checksum"))
    throw Error(ErrorKind::data,
                fmt::format("{}: belongs to another run than its .json file, or is damaged; run "
                            "vpr-query again, with --force",
                            path.string()));
  return array;
}

/// "fps": frames a second.
inline double read_fps(const Fields& fields) {
  const Json& json = fields["fps"];
  if (!json.is_number()) fields.fail("\"fps\" is no number");
  const auto fps = json.get<double>();
  if (!(fps > 0 && std::isfinite(fps))) fields.fail("\"fps\" is out of range");
  return fps;
}

/// The numbers of frames in a list, each below `count`.
inline std::vector<size_t> read_frame_list(const Fields& fields, const std::string& key,
                                           uint64_t count) {
  std::vector<size_t> frames;
  for (const Json& frame : fields.list(key)) {
    if (!frame.is_number_unsigned() || frame.get<uint64_t>() >= count)
      fields.fail(fmt::format("\"{}\" holds what is no frame", key));
    frames.push_back(frame.get<size_t>());
  }
  return frames;
}

/// The value of an optional, or null.
Json or_null(const auto& value) { return value ? Json(*value) : Json(); }

}  // namespace vpr
