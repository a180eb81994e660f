// A rendered world: its frames, poses, ground truth, and a data set file that lists them.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "base/json_fwd.h"
#include "base/monitor.h"
#include "synth/walking.h"
#include "synth/world.h"

namespace vpr {

/// A walk with the camera pose of each frame.
struct RecordedWalk {
  const Walk* walk = nullptr;  ///< of the world
  std::vector<CameraPose> poses;
};

/// The poses of all walks, in the order of the world. Throws Error(usage) if a walk or a view of a
/// place is inside a wall.
std::vector<RecordedWalk> record_walks(const World& world);

/// Names and contents of all files other than frames:
/// - a training and a query frame show the same place if they are on one floor, at most
///   same_place_m apart, and their headings differ by at most kSameHeadingDeg; the pair is ignored
///   up to ignore_m;
/// - a query frame shows a place if it is within kPlaceRadiusM and its heading differs from that
///   of a view by at most kSameHeadingDeg; it is ignored up to kPlaceIgnoreM;
/// - parts of pretraining walks that would show a place, or be ignored, are omitted.
/// Walls are not considered: places on two sides of a thin wall count as near.
std::vector<std::pair<std::string, std::string>> recording_texts(
    const World& world, const std::vector<RecordedWalk>& walks);

struct RecordingSize {
  size_t frames = 0;  ///< of walks
  size_t views = 0;   ///< of places
};

Json recording_json(const World& world, const RecordingSize& size);
Json world_schema();
Json world_info_schema();

/// Renders a world into an existing folder:
///   WALK/00000.jpg ..., WALK/poses.csv  frame,time,x,y,heading,floor of every walk
///   places/PLACE/0.jpg ..., places.csv  place,view,x,y,heading,floor of every view of a place
///   plan.csv                            floor,x0,y0,x1,y1,kind of every wall
///   WALK.ground_truth.csv, WALK.places.csv  of every query, against training frames and places
///   dataset.json                        all of it as vpr.dataset/3
/// Returns the number of images. Byte-identical for a world, with any number of threads. Throws
/// Error(usage) if a walk or a view is inside a wall, Error(output) if a file cannot be written.
RecordingSize write_recording(const World& world, const std::filesystem::path& folder,
                              const Monitor& monitor);

/// Whether a folder holds only files that write_recording writes. Throws Error(output) if it cannot
/// be read.
bool is_recording_folder(const std::filesystem::path& folder);

}  // namespace vpr
