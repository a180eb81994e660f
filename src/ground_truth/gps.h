// Ground truth by latitude and longitude.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "ground_truth/formats.h"
#include "ground_truth/trajectory.h"

namespace vpr {

/// The argument's path has the fixes of the query, its `reference` those of the training sequence;
/// each is a CSV (gps_csv.h), with a range of frames where the sequence had one. By time as
/// trajectories (pose_times.h). Distances are straight lines between points on the ellipsoid,
/// heights left out. Warns where more than half of the frames of a side have no fix; throws
/// Error(data) where none has, and as the readers do.
std::string read_gps(GroundTruthBuilder& builder);

/// Whether the first line is the header of a CSV that names latitudes and longitudes.
bool is_gps(const FileStart& start);

/// The fixes of one side on the earth. `images` and `frames` as read_gps_csv has them.
Trajectory read_fixes(const std::filesystem::path& path, const std::filesystem::path& images = {},
                      std::optional<size_t> frames = std::nullopt);

/// Turns and shifts a trajectory on the earth so that its first fix is 0, 0, 0, and x, y and z are
/// metres to the east, north and up; leaves any other as it is.
void level(Trajectory& trajectory);

}  // namespace vpr
