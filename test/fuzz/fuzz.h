// The frame of all fuzz targets: a target is one function, run, that reads an input.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace vpr::fuzz {

/// What a target does with an input, which is any bytes. An Error that bad input may throw ends
/// one run well; any other exception, a failed `require`, and what sanitizers find are findings.
void run(std::string_view input);

/// The path of the process's one file that exists only in memory, now with these bytes.
std::filesystem::path memory_file(std::string_view bytes);

/// A file among several in one input.
struct Part {
  std::string name;
  std::string bytes;
};

/// Every part starts with a line "--- NAME"; the line feed before the next such line is no part of
/// it. Names are of letters, digits, dots and underscores; parts of other names, and what is before
/// the first, are left out. Of two parts of one name, the first counts.
std::vector<Part> split_parts(std::string_view input);

/// The bytes of a part; nothing if there is none of that name.
const std::string* find_part(const std::vector<Part>& parts, std::string_view name);

/// The path of the process's own folder, now with these files and no others.
std::filesystem::path folder_of(const std::vector<Part>& parts);

/// Ends the process, as a finding, unless `good`.
void require(bool good);

/// Whether bad input may throw it: neither a defect of the program, nor an output.
bool is_refusal(const Error& error);

/// Does the work; whether it refused its input.
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
