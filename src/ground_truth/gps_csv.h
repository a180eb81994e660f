// Lists of GPS fixes as CSV.
#pragma once

#include <filesystem>
#include <optional>

#include "ground_truth/trajectory.h"

namespace vpr {

/// A CSV with a header that names latitude and longitude (gps_columns.h), and maybe heading, in
/// degrees. A line is of the frame in its column `frame`; or of the image in its column `image`
/// (or name, file, filename), where `images`, the folder or list of the sequence, is given: names
/// without folders count, and every line must name an image of the sequence, which may have images
/// without a line; or of the moment in its column `time` (or timestamp), as numbers (times.h) or as
/// dates (calendar_time.h, of which those without a zone are UTC); or line i is that of frame i.
/// Lines without a fix give no pose. `frames`: how many the sequence has, if that is known, where
/// lines are of frames by their numbers. Positions are on the earth. A range behind the path picks
/// lines, or frames by their numbers. Throws Error(input) if a file can't be read, Error(usage) for
/// images by name without `images`, Error(data), naming the line, if it is damaged.
Trajectory read_gps_csv(const std::filesystem::path& path, const std::filesystem::path& images,
                        std::optional<size_t> frames);

}  // namespace vpr
