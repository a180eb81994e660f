// How far somebody has walked at each frame.
#pragma once

#include <filesystem>
#include <vector>

namespace vpr {

/// Metres from the first frame to each of `frames` frames along the straight lines between their
/// positions: a CSV file with columns frame, x and y (others are not looked at), in metres, one
/// line for every frame, in any order. Throws Error(input) if it can't be read, Error(data), naming
/// the line, if it is damaged, or a frame is missing, double or out of range.
std::vector<double> read_travelled(const std::filesystem::path& path, size_t frames);

}  // namespace vpr
