// What to try when a FAB-MAP query recognised nothing.
#pragma once

#include <cstddef>
#include <optional>

#include "recognition/result.h"

namespace vpr {

/// What a lower t_p would give.
struct LowerThreshold {
  Match best;                             ///< the likeliest match of all frames
  std::optional<double> place_threshold;  ///< the first t_p below the result's, of 0.9, 0.8 ...
                                          ///< 0.1, 0.09 ... 0.01, that recognises something; none
                                          ///< if none of them does
  size_t frames = 0;                      ///< in which it does, by the likeliest view of each
};

/// Looks for a lower t_p that recognises something. Nothing where no frame has a best match. The
/// c_w of the result holds for the lower t_p, too.
std::optional<LowerThreshold> lower_place_threshold(const Result& result);

}  // namespace vpr
