// JSON written by programs.
#pragma once

#include <filesystem>
#include <string>

#include "base/json.h"
#include "support.h"

namespace vpr::test {

inline Json file_json(const std::filesystem::path& path) { return Json::parse(read_text(path)); }

/// The output of a program, which must have exited with 0.
inline Json printed_json(const RunOutcome& outcome) { return Json::parse(ok(outcome).out); }
inline Json printed_json(const std::string& program, const Words& arguments) {
  return printed_json(run_program(program, arguments));
}

}  // namespace vpr::test
