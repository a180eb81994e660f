// What a run reads, as far as its command line tells: files that no output may replace.
#pragma once

#include <filesystem>
#include <vector>

#include "parser.h"

namespace vpr {

/// Every value of an option or argument that names something that exists, but for options that
/// name outputs; sequences with their frames, databases with their files, results with their
/// companions, and data sets with the files that they name.
std::vector<std::filesystem::path> run_inputs(const std::vector<GivenFlag>& given);

}  // namespace vpr
