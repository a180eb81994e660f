// Recognitions of FAB-MAP for people: one line for as long as a place is recognised.
#pragma once

#include <span>
#include <vector>

#include "recognition/match.h"

namespace vpr {

/// Recognitions that belong together.
struct PlaceRun {
  size_t first_frame = 0;
  size_t last_frame = 0;
  uint32_t first_place = 0;  ///< the smallest index
  uint32_t last_place = 0;
  size_t hits = 0;
  double probability = 0;  ///< the largest

  bool operator==(const PlaceRun&) const = default;
};

/// `hits` are a result's: by frame, then place. A hit belongs to the latest run that has a hit at
/// most `reach` (at least 1) frames before it, in a place whose index is at most `reach_places`
/// away: 0 for places of many views, more where each training frame is a place of its own. Runs are
/// in the order of their first hits.
std::vector<PlaceRun> place_runs(std::span<const Match> hits, size_t reach, size_t reach_places);

}  // namespace vpr
