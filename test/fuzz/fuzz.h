// Common parts of all fuzz targets: a target is a function, run, that reads an input.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace vpr::fuzz {

/// Processes an input of any bytes. An Error that bad input may throw ends the run normally; any
/// other exception, a failed `require`, and findings of sanitizers are findings.
void run(std::string_view input);

/// The path of the process's only file, which exists only in memory, with these bytes.
std::filesystem::path memory_file(std::string_view bytes);

/// One of several files in one input.
struct Part {
  std::string name;
  std::string bytes;
};

/// Every part starts with a line "--- NAME"; the line feed before the next of these lines is not
/// part of it. Names have letters, digits, dots and underscores; parts with other names, and the
/// text before the first part, are ignored. If two parts have the same name, the first one counts.
std::vector<Part> split_parts(std::string_view input);

/// The bytes of a part, or null.
const std::string* find_part(const std::vector<Part>& parts, std::string_view name);

/// The path of the process's own folder, with exactly these files.
std::filesystem::path folder_of(const std::vector<Part>& parts);

/// The bytes of a zip archive of these files.
std::string packed(const std::vector<Part>& parts);

/// Ends the process with a finding unless `good`.
void require(bool good);

/// Whether bad input may throw it: neither an internal nor an output error.
bool is_refusal(const Error& error);

/// Calls `work`; returns whether it refused its input.
template <class Work>
bool refuses(Work&& work) {
  try {
    work();
  } catch (const Error& error) {
    require(is_refusal(error));
    return true;
  }
  return false;
}

}  // namespace vpr::fuzz
