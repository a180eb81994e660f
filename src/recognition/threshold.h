// t_r: from a threshold on a quotient to a limit on integer distances.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "base/json.h"

namespace vpr {

/// relative: D / max(D) < t_r, the maximum over all cells of that training sequence and the query
/// (the paper's 0.3, 0.4, 0.5). bits: D / c_l < t_r, in bits a frame.
enum class ThresholdScale { relative, bits };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<ThresholdScale> = {"relative", "bits"};

/// The smallest distance that is no hit: the smallest integer D with D / divisor >= threshold, as
/// an IEEE double division. Where the divisor is 0 the quotient counts as 0. threshold is finite.
uint32_t distance_limit(double threshold, uint32_t divisor);

}  // namespace vpr
