// Running gnuplot, where it is installed.
#pragma once

#include <filesystem>
#include <string>

namespace vpr {

/// Runs a script in a folder, in which it names its outputs without a path: what a folder is called
/// is nothing that gnuplot should read. Its messages go nowhere. False if it fails.
bool run_gnuplot(const std::string& script, const std::filesystem::path& folder);

/// Whether a PNG or SVG file (by its extension) is there to its end: gnuplot does not say that a
/// disk was full.
bool is_whole_picture(const std::filesystem::path& path);

}  // namespace vpr
