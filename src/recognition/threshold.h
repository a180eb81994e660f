// t_r: from a threshold on a quotient to a limit on integer distances.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "base/enum_names.h"
#include "matching/standardization.h"

namespace vpr {

/// relative: D / max(D) < t_r, the maximum over all cells of that training sequence and the query
/// (the paper's 0.3, 0.4, 0.5). bits: D / c_l < t_r, the mean frame distance in its own unit
/// (frame_distances; of LDB bits). mean_z: the mean z-score of the window < t_r.
enum class ThresholdScale { relative, bits, mean_z };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<ThresholdScale> = {"relative", "bits",
                                                                               "mean-z"};

/// An automatic t_r of one training sequence, on the scale bits.
struct AutomaticThreshold {
  double value = 0;
  bool is_largest = false;  ///< the largest that one may be; closest windows are no reason for less
};

/// The smallest distance that is no hit: the smallest integer D with D / divisor >= threshold, as
/// an IEEE double division; divisor is not negative. Where it is 0 the quotient counts as 0.
/// threshold is finite.
uint32_t distance_limit(double threshold, double divisor);

/// The same for standardized scores of a window, whose mean z is compared: the smallest biased sum
/// (matching/score_kernels.h) with mean_z >= threshold.
uint32_t score_limit(double threshold, size_t window_length);

/// What biased sums of window_length scores are above the sum of z in units of 1 / kScoreUnit;
/// window_length is at most kMaxScoredWindow.
int64_t score_offset(size_t window_length);

/// The mean z of a window from its biased sum.
double mean_z(uint32_t biased_sum, size_t window_length);

}  // namespace vpr
