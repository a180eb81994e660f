// How far along its path a walk is at every frame: its paces, stops and cuts.
#pragma once

#include <functional>
#include <vector>

#include "synth/world.h"

namespace vpr {

/// One frame of a walk.
struct Progress {
  double way_m = 0;          ///< along the path
  double walking_s = 0;      ///< that were walked so far, without stops
  bool follows_cut = false;  ///< the recording was cut just before
};

/// Whether a walk has paces, stops or cuts of its own, and so as many frames as they give.
bool is_uneven(const Walk& walk);

/// The frames of a walk along a path of `length_m`, at least one. `variation` gives by how much
/// more than the stated speed is walked at a time in seconds, as a share of it. Stops and cuts are
/// met in their order; a frame is taken where one stands, and the first behind a cut is where the
/// step that met it ends. Throws Error(usage), naming the walk, if a stop or a cut lies where the
/// walk does not come by, or there are too many frames.
std::vector<Progress> uneven_progress(const World& world, const Walk& walk, double length_m,
                                      const std::function<double(double time_s)>& variation);

/// The same for a walk that is_uneven is not: walk.frames, or as many as the speed gives, from end
/// to end.
std::vector<Progress> even_progress(const World& world, const Walk& walk, double length_m,
                                    const std::function<double(double time_s)>& variation);

}  // namespace vpr
