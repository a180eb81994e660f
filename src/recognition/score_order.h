// Scores as integers that sort the best first, so that thresholds and ties are exact.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <string_view>

#include "base/enum_names.h"

namespace vpr {

/// A small distance is good; a large similarity is.
enum class ScoreOrder { distance, similarity };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<ScoreOrder> = {"distance",
                                                                           "similarity"};

/// The key of "no score": behind all others.
inline constexpr uint64_t kNoScore = std::numeric_limits<uint64_t>::max();

/// Smaller keys are better scores, equal keys equal scores (-0 is 0). Infinite scores are ordered
/// like others; NaN is no score.
inline uint64_t score_key(double score, ScoreOrder kind) {
  if (score != score) return kNoScore;
  const auto bits = std::bit_cast<uint64_t>(score == 0 ? 0.0 : score);
  const uint64_t rising = bits >> 63 != 0 ? ~bits : bits | uint64_t{1} << 63;
  return kind == ScoreOrder::distance ? rising : ~rising;
}

/// The score of a key; NaN for kNoScore.
inline double score_of_key(uint64_t key, ScoreOrder kind) {
  if (key == kNoScore) return std::numeric_limits<double>::quiet_NaN();
  const uint64_t rising = kind == ScoreOrder::distance ? key : ~key;
  return std::bit_cast<double>(rising >> 63 != 0 ? rising ^ uint64_t{1} << 63 : ~rising);
}

}  // namespace vpr
