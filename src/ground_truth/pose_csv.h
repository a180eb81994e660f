// The one reader of poses as CSV: ground truth, ways in metres and maps take them from here.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ground_truth/gps.h"

namespace vpr {

/// Metres, and degrees.
struct CsvPose {
  std::array<double, 3> position{};   ///< x, y and 0, or on the earth (gps.h)
  std::optional<Geographic> place;    ///< of files with latitudes and longitudes
  std::optional<double> heading_deg;  ///< none without such a column
  std::string floor;                  ///< empty without such a column
};

/// How many frames the sequence has: `frames` of them or, where that is not known, one more than
/// the largest that is named, which must be below `most_frames`.
struct PoseCsvRules {
  std::optional<size_t> frames;
  size_t most_frames = 10'000'000;
};

/// Whether a header has the columns that poses need: frame, x and y.
bool has_pose_columns(const std::vector<std::string>& header);

/// One entry a frame; nothing for a frame without a line or, in a file that has latitudes and
/// longitudes (gps.h) instead of x and y, without a fix. `path` may end in a range
/// (poses.csv@100:200): then its frames count from the range's first, in its steps, and others are
/// left out. Frames may stand in any order; other columns than these, heading and floor are not
/// looked at. Throws Error(input) if the file can't be read, Error(data), naming the line, if
/// it is damaged, a frame is out of range or given twice, or the range has another number of
/// frames.
std::vector<std::optional<CsvPose>> read_pose_csv(const std::filesystem::path& path,
                                                  const PoseCsvRules& rules);

}  // namespace vpr
