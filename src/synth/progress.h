// The position of a walk along its path at every frame, with its speeds, stops and cuts.
#pragma once

#include <functional>
#include <vector>

#include "synth/world.h"

namespace vpr {

/// One frame of a walk.
struct Progress {
  double way_m = 0;          ///< along the path
  double walking_s = 0;      ///< time walked so far, without stops
  bool follows_cut = false;  ///< the recording was cut just before this frame
};

/// Whether a walk has its own speeds, stops or cuts, which determine its number of frames.
bool is_uneven(const Walk& walk);

/// The frames of a walk along a path of `length_m`, at least one. `variation` returns the relative
/// deviation from the stated speed at a time in seconds. The walk passes stops and cuts in their
/// order. Frames are recorded during a stop, and the first frame after a cut is at the end of the
/// step that reached it. Throws Error(usage), with the name of the walk, if the walk does not reach
/// a stop or a cut, or if there are too many frames.
std::vector<Progress> uneven_progress(const World& world, const Walk& walk, double length_m,
                                      const std::function<double(double time_s)>& variation);

/// The frames of a walk that is not is_uneven: walk.frames, or a number determined by the speed,
/// from end to end.
std::vector<Progress> even_progress(const World& world, const Walk& walk, double length_m,
                                    const std::function<double(double time_s)>& variation);

}  // namespace vpr
