// How far somebody has walked at each frame.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "images/warp.h"

namespace vpr {

struct Monitor;

/// Metres from the first frame to each of `frames` frames along the straight lines between their
/// positions: poses as read_pose_csv reads them. Metres are an extra: where a frame has no pose, it
/// warns and gives none at all. Throws Error(data) where positions are too far apart for metres,
/// and otherwise as read_pose_csv does. Of a `replay`, whose frames there are so many, the file has
/// the poses of the recording.
std::vector<double> read_travelled(const std::filesystem::path& path, size_t frames,
                                   const Monitor& monitor,
                                   const std::optional<Replay>& replay = {});

}  // namespace vpr
