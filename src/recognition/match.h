// A query window and what it was compared with: hits and best matches of any method.
#pragma once

#include <cstdint>

namespace vpr {

/// Windows are named by their first frame; those of FAB-MAP are single frames.
struct Match {
  uint32_t query = 0;   ///< window of the query
  uint32_t target = 0;  ///< training sequence; 0, the only one, of places
  uint32_t train = 0;   ///< window of the sequence; index of a place
  uint32_t view = 0;    ///< of a place, its likeliest; 0 of a window
  double score = 0;     ///< as ScoreKind says: a whole number summed over the window, or the
                        ///< probability of the view

  bool operator==(const Match&) const = default;
};

}  // namespace vpr
