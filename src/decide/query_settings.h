// The settings of a query: everything that can change a result. JSON keys are the names of the
// flags. With the tables of scores and decisions.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/enum_names.h"
#include "base/json_fwd.h"
#include "decide/clustering.h"
#include "fabmap/model.h"
#include "match/filter_settings.h"
#include "match/match.h"
#include "match/zscores.h"

namespace vpr {

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
  size_t longest_window = {};              ///< in frames: longer sums may exceed 32 bits
  int32_t missing = {};                    ///< the missing score in a saved matrix
  bool needs_statistics = {};              ///< a z-score, from statistics of the training frames
  bool is_offline = {};                    ///< depends on later frames of the query
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

/// threshold: every window pair with a score below t_r. margin: the best match of a query window if
/// its margin is at least X.
enum class Decision { threshold, margin };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<Decision> = {"threshold", "margin"};

/// An entry of the table of decisions, in the order of Decision.
struct DecisionKind {
  std::string_view recognitions = {};  ///< their definition, for reports; {} is the score
  std::string_view symbol = {};        ///< of its setting: t_r, margin
  ScoreOrder order = {};               ///< distance: a larger setting accepts more
  std::span<const std::string_view> settings = {};  ///< keys of settings of this decision only
};

std::span<const DecisionKind> decision_kinds();
const DecisionKind& decision_kind(Decision decision);

/// The settings of the sequence methods: FastABLE, OpenABLE, LSH, the filter.
struct SequenceQuerySettings {
  std::string method = "fastable";
  uint64_t window_length = 40;               ///< c_l
  std::optional<double> distance_threshold;  ///< t_r; nullopt: automatic
  /// The scale of a t_r that is a number; automatic ones are in bits. Nullopt: the default of the
  /// score (scale_of).
  std::optional<ThresholdScale> threshold_scale;
  std::optional<double> safety_factor;      ///< of automatic t_r; nullopt: the database's
  std::vector<std::string> only_sequences;  ///< empty: all
  bool skip_unreadable = false;
  ClusterSettings clustering;
  LshSettings lsh;  ///< for the method lsh
  Score score = Score::raw;
  ZScoreSettings zscore;
  std::vector<std::string> rates;  ///< of windows, "3/2": training per query frames; empty: 1
  Decision decision = Decision::threshold;
  std::optional<double> margin;              ///< X, in score per frame; nullopt: default_margin
  std::optional<uint64_t> exclusion_frames;  ///< exclusion radius w; nullopt: one per sequence
  /// "A=B": sequences of the same place. Empty: detected; "none": all places differ.
  std::vector<std::string> same_place;
  FilterSettings filter;                ///< for the method filter
  std::optional<double> fusion_weight;  ///< beta, deviations per nat; nullopt: without FAB-MAP
  /// The query against its own past, without a database. The remaining settings are for loops.
  bool loop = false;
  uint64_t loop_gap = 0;   ///< minimum distance to a match, in frames; 0: loop_gap_s
  double loop_gap_s = 0;   ///< seconds
  std::string descriptor;  ///< of descriptor_kinds(); empty: ldb, or vectors for arrays
};

template <class Visitor>
void visit_fields(SequenceQuerySettings& settings, Visitor&& visit) {
  visit("method", settings.method);
  visit("c_l", settings.window_length);
  visit("t_r", settings.distance_threshold);
  visit("t_r_scale", settings.threshold_scale);
  visit("safety_factor", settings.safety_factor);
  visit("only_sequence", settings.only_sequences);
  visit("skip_unreadable", settings.skip_unreadable);
  visit("clustering", settings.clustering);
  visit("lsh", settings.lsh);
  visit("score", settings.score);
  visit("zscore", settings.zscore);
  visit("rates", settings.rates);
  visit("decide", settings.decision);
  visit("margin", settings.margin);
  visit("exclusion_frames", settings.exclusion_frames);
  visit("same_place", settings.same_place);
  visit("filter", settings.filter);
  visit("fusion_weight", settings.fusion_weight);
  visit("loop", settings.loop);
  visit("loop_gap", settings.loop_gap);
  visit("loop_gap_s", settings.loop_gap_s);
  visit("descriptor", settings.descriptor);
}

/// The settings of FAB-MAP.
struct FabmapQuerySettings {
  std::string method = "fabmap";
  std::string variant = "fabmap2";
  double place_threshold = 0.99;  ///< t_p; the probability of a recognized view is above (strict)
  uint64_t window = 1;            ///< c_w: for this number of consecutive frames
  WordModel word_model = WordModel::tree;
  NewPlaceModel new_place = NewPlaceModel::pretrain;
  uint64_t new_place_samples = 0;  ///< pretraining frames drawn with the seed; 0: all
  double p_seen_if_there = 0.39;
  double p_seen_if_not = 0;
  int64_t lut_digits = 6;
  bool loop = false;       ///< frames of the query are places for later frames
  uint64_t loop_gap = 10;  ///< except for this number of frames directly after them
  bool skip_unreadable = false;
  PosteriorSettings posterior;
};

template <class Visitor>
void visit_fields(FabmapQuerySettings& settings, Visitor&& visit) {
  visit("method", settings.method);
  visit("variant", settings.variant);
  visit("t_p", settings.place_threshold);
  visit("c_w", settings.window);
  visit("word_model", settings.word_model);
  visit("new_place", settings.new_place);
  visit("new_place_samples", settings.new_place_samples);
  visit("p_seen_if_there", settings.p_seen_if_there);
  visit("p_seen_if_not", settings.p_seen_if_not);
  visit("lut_digits", settings.lut_digits);
  visit("loop", settings.loop);
  visit("loop_gap", settings.loop_gap);
  visit("skip_unreadable", settings.skip_unreadable);
  visit("posterior", settings.posterior);
}

/// The settings of any method.
using QuerySettings = std::variant<SequenceQuerySettings, FabmapQuerySettings>;

/// The default margin of the filter, in standard deviations.
inline constexpr double kFilterMargin = 15;

/// Throws Error(usage) unless 1 <= c_l <= kMaxWindowLength.
void check_window_length(uint64_t window_length);
/// Throws Error(usage) unless the factor is finite and above 0.
void check_safety_factor(double factor);

/// The scale of t_r: the setting, or else the score's default. Loop queries use the scale of single
/// scores by default, which needs no other window.
ThresholdScale scale_of(const SequenceQuerySettings& settings);

/// The settings as in files, defaults included: with the default scale, without the settings of
/// other methods, scores and decisions.
Json settings_in_force(const QuerySettings& settings);

/// The name of the method: an entry of sequence_methods(), or "fabmap".
const std::string& method_of(const QuerySettings& settings);
const ScoreKind& score_of(const QuerySettings& settings);
/// The number of frames of a window: c_l, or 1 for FAB-MAP, which compares frames.
size_t window_length_of(const QuerySettings& settings);

}  // namespace vpr
