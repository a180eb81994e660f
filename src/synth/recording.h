// Writes a rendered world as a data set: frames, poses, plan, places and ground truth.
#pragma once

#include <filesystem>

#include "base/json_fwd.h"
#include "base/monitor.h"
#include "synth/world.h"

namespace vpr {

/// How much was rendered.
struct RecordingSize {
  size_t frames = 0;  ///< of walks
  size_t views = 0;   ///< of places
};

/// What was rendered (vpr.world-info/1).
Json recording_json(const World& world, const RecordingSize& size);

/// Renders a world into an existing folder:
///   WALK/00000.jpg ..., WALK/poses.csv  frame,time,x,y,heading,floor of every walk
///   places/PLACE/0.jpg ..., places.csv  place,view,x,y,heading,floor of every view of a place
///   plan.csv                            floor,x0,y0,x1,y1,kind of every wall
///   WALK.ground_truth.csv, WALK.places.csv  of every query, against training frames and places
///   dataset.json                        all of it as vpr.dataset/1
/// Returns what was rendered. Byte-identical for a world, on any number of threads. Throws
/// Error(usage) if a walk or a view stands in a wall, Error(output) if a file can't be written.
RecordingSize write_recording(const World& world, const std::filesystem::path& folder,
                              const Monitor& monitor);

/// Whether a folder holds what write_recording writes, and nothing else.
bool is_recording_folder(const std::filesystem::path& folder);

}  // namespace vpr
