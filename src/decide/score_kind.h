// The table of scores: what the score of a match is, how two are ordered, and thresholds on it.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/enum_names.h"
#include "match/zscore_model.h"

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

/// relative: D / max(D) < t_r, the maximum over all cells of that training sequence and the query
/// (the paper's 0.3, 0.4, 0.5). bits: D / c_l < t_r, the mean frame distance in its own unit
/// (frame_distances; of LDB bits). mean_z: the mean z-score of the window < t_r.
enum class ThresholdScale { relative, bits, mean_z };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<ThresholdScale> = {"relative", "bits",
                                                                               "mean-z"};

/// One row of the table. That of a window's score has the place of its value of Score, whose name
/// is its name; the last row is FAB-MAP's, which has no windows: what is about them is empty there,
/// and no function.
///
/// Rows of matchers hold sums of whole numbers that are never negative: a score with a sign is
/// biased, and `offset` is what is taken from a sum for files and reports.
struct ScoreKind {
  ScoreOrder order = {};                ///< which of two is better
  std::string_view measure = {};        ///< in sentences: "distance"
  std::string_view title = {};          ///< of a chart's axis, with the unit of sums over a window
  std::string_view window_symbol = {};  ///< of the setting that says how many frames: c_l, c_w
  std::string_view threshold_symbol = {};  ///< t_r, t_p
  std::string_view frame_unit = {};        ///< of frame_value, as the head of a column
  int frame_digits = {};                   ///< behind the point, where frame_value is printed
  ThresholdScale number_scale = {};  ///< of a t_r that is a number, where the user names no scale
  ThresholdScale frame_scale = {};   ///< of frame_value: of t_r of a sequence against its own past
  size_t longest_window = {};        ///< in frames: sums of longer ones may not fit into 32 bits
  int32_t missing = {};              ///< in a saved matrix, where there is no score
  bool needs_statistics = {};        ///< of the training frames: it is standardized
  bool is_offline = {};              ///< it depends on later frames of the query
  std::span<const std::string_view> settings =
      {};  ///< keys that only some scores have, of this one
  int64_t (*offset)(size_t window_length) = nullptr;
  /// Of the score of a window, as files hold it.
  double (*frame_value)(double score, size_t window_length) = nullptr;

  std::string_view margin_unit = {};  ///< of a margin a frame, in sentences: "bits a frame"
  double most_margin = {};            ///< no margin a frame is larger
  /// What no automatic margin a frame is below, where training frames differ by typical_distance.
  double (*least_margin)(double typical_distance, size_t window_length) = nullptr;
};

/// All rows, that of FAB-MAP last.
std::span<const ScoreKind> score_kinds();
/// The row of a score of windows.
const ScoreKind& score_kind(Score score);
/// The row of FAB-MAP: how likely a frame shows a place.
const ScoreKind& probability_kind();

/// Whether score a is better than b; not if they are equal.
inline bool is_better(double a, double b, ScoreOrder order) {
  return order == ScoreOrder::distance ? a < b : a > b;
}

/// Keys of settings that only some scores have, and that stand in files only of those.
std::span<const std::string_view> score_settings();

/// An automatic t_r of one training sequence, on the scale bits.
struct AutomaticThreshold {
  double value = 0;
  bool is_largest = false;  ///< the largest that one may be; closest windows are no reason for less
};

/// The smallest distance that is no recognition: the smallest integer D with D / divisor >=
/// threshold, as an IEEE double division; divisor is not negative. Where it is 0 the quotient
/// counts as 0. threshold is finite.
uint32_t distance_limit(double threshold, double divisor);

/// The same for z-scores of a window, whose mean z is compared: the smallest biased sum
/// (match/score_kernels.h) with mean_z >= threshold.
uint32_t score_limit(double threshold, size_t window_length);

/// What biased sums of window_length scores are above the sum of z in units of 1 / kScoreUnit;
/// window_length is at most kMaxScoredWindow.
int64_t score_offset(size_t window_length);

/// The mean z of a window from its biased sum.
double mean_z(uint32_t biased_sum, size_t window_length);

}  // namespace vpr
