// The scores of windows: the table of scores, and the table of the stages that compute them from
// frame distances.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "base/enum_names.h"
#include "match/match.h"
#include "match/zscores.h"

namespace vpr {

struct SequenceQuerySettings;

/// The terms of a window's score: raw frame distances, or z-scores with statistics of earlier
/// frames.
enum class Score { raw, zscore };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<Score> = {"raw", "zscore"};

/// Whether smaller or larger scores are better.
enum class ScoreOrder { distance, similarity };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<ScoreOrder> = {"distance",
                                                                           "similarity"};

/// Whether score a is better than b; false if they are equal.
inline bool is_better(double a, double b, ScoreOrder order) {
  return order == ScoreOrder::distance ? a < b : a > b;
}

/// The key of a missing score; larger than all others.
inline constexpr uint64_t kNoScore = std::numeric_limits<uint64_t>::max();

/// Smaller keys are better scores; equal keys are equal scores (-0 is 0). Infinite scores are
/// ordered like others; NaN is a missing score.
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

/// relative: D / max(D) < t_r, with the maximum over all cells of the training sequence and the
/// query (the paper's 0.3, 0.4, 0.5). bits: D / c_l < t_r, the mean frame distance in its own unit
/// (frame_distances; bits for LDB). mean_z: the mean z-score of the window < t_r.
enum class ThresholdScale { relative, bits, mean_z };
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<ThresholdScale> = {"relative", "bits",
                                                                               "mean-z"};

/// An entry of the table of scores, in the order of Score. The last entry is FAB-MAP's: it has no
/// windows, so their fields are empty and its functions null.
///
/// Matchers sum integers that are never negative. A score with a sign is therefore biased: files
/// and reports hold the sum minus `offset`.
struct ScoreKind {
  ScoreOrder order = {};
  std::string_view measure = {};           ///< in sentences: "distance"
  std::string_view window_symbol = {};     ///< c_l, c_w
  std::string_view threshold_symbol = {};  ///< t_r, t_p
  ThresholdScale number_scale = {};        ///< default scale of a t_r that is a number
  ThresholdScale frame_scale = {};         ///< of frame_value; the default for loop queries
  int32_t missing = {};                    ///< the missing score in a saved matrix
  bool needs_statistics = {};              ///< a z-score, from statistics of the training frames
  int64_t (*offset)(size_t window_length) = nullptr;
  /// The score per frame of a window's score as in files.
  double (*frame_value)(double score, size_t window_length) = nullptr;

  std::string_view margin_unit = {};  ///< of a margin per frame, in sentences: "bits per frame"
  double most_margin = {};            ///< upper bound of margins per frame
  /// The default margin per frame, from the typical distance of training frames.
  double (*default_margin)(double typical_distance, size_t window_length) = nullptr;
};

/// All entries; FAB-MAP's is the last.
std::span<const ScoreKind> score_kinds();
const ScoreKind& score_kind(Score score);
/// The entry of FAB-MAP: the probability of a place.
const ScoreKind& probability_kind();

/// The smallest distance that is not a recognition: the smallest integer D with D / divisor >=
/// threshold, as an IEEE double division; divisor is not negative. With a divisor of 0 the quotient
/// counts as 0. threshold is finite.
uint32_t distance_limit(double threshold, double divisor);

/// The smallest biased sum of z-scores (match/score_kernels.h) with mean_z >= threshold.
uint32_t score_limit(double threshold, size_t window_length);

/// The difference between biased sums of window_length scores and the sum of z in units of
/// 1 / kScoreUnit; window_length is at most kMaxScoredWindow.
int64_t score_offset(size_t window_length);

/// The mean z of a window from its biased sum.
double mean_z(uint32_t biased_sum, size_t window_length);

/// An entry of the table of score stages.
struct ScoreStage {
  bool (*is_chosen)(const SequenceQuerySettings& settings);
  /// Adds what the stage starts from. `statistics`: of the database, or null. Throws Error(usage)
  /// if the stage needs what the database lacks.
  void (*prepare)(const SequenceQuerySettings& settings, const TrainStatistics* statistics,
                  ScoreBasis& basis);
  /// Starts a query, batch or live.
  StartedStage (*start)(const std::shared_ptr<const ScoreBasis>& basis);
};

/// The score stages of a query, in the order of the table, and what they start from.
struct ScoreStages {
  std::vector<const ScoreStage*> rows;  ///< empty: raw distances
  std::shared_ptr<const ScoreBasis> basis;

  /// The stages, started for one query.
  std::vector<StartedStage> start() const;
};

/// The stages that the settings choose. Throws Error(usage) as ScoreStage::prepare does.
ScoreStages stages_of(const SequenceQuerySettings& settings, const TrainStatistics* statistics);

/// The scores of a whole query.
FrameDistances scored(FrameDistances distances, const ScoreStages& stages);

}  // namespace vpr
