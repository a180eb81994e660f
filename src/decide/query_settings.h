// What a query is set to: everything that can change a result. JSON keys are the names of the
// flags.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/enum_names.h"
#include "base/json_fwd.h"
#include "decide/clustering.h"
#include "decide/score_kind.h"
#include "fabmap/model.h"
#include "fabmap/posterior.h"
#include "match/filter_settings.h"
#include "match/rows.h"

namespace vpr {

/// threshold: every pair with a score below t_r. margin: the best match of a query window, if it is
/// by at least X better than the best one elsewhere.
enum class Decision { threshold, margin };
template <>
inline constexpr std::array<std::string_view, 2> kEnumNames<Decision> = {"threshold", "margin"};

/// One row of the table, at the place of its value of Decision, whose name is its name.
struct DecisionKind {
  std::string_view recognitions =
      {};                        ///< definition of its recognitions, for reports; {} is the score
  std::string_view symbol = {};  ///< of its setting: t_r, margin
  ScoreOrder order = {};         ///< distance: more is accepted where its setting is larger
  std::span<const std::string_view> settings = {};  ///< keys of settings that only it has
};

std::span<const DecisionKind> decision_kinds();
const DecisionKind& decision_kind(Decision decision);

/// The settings of the sequence methods: FastABLE, OpenABLE, LSH, the filter.
struct SequenceQuerySettings {
  std::string method = "fastable";
  uint64_t window_length = 40;               ///< c_l
  std::optional<double> distance_threshold;  ///< t_r; none: automatic
  /// The scale of a t_r that is a number; automatic ones are in bits. None: the default of the
  /// score (scale_of).
  std::optional<ThresholdScale> threshold_scale;
  std::optional<double> safety_factor;      ///< of automatic t_r; none: the database's
  std::vector<std::string> only_sequences;  ///< empty: all
  bool skip_unreadable = false;
  ClusterSettings clustering;
  LshSettings lsh;  ///< of the method lsh
  Score score = Score::raw;
  ZScoreSettings zscore;
  std::vector<std::string>
      rates;  ///< of windows, "3/2": training frames for query frames; empty: 1
  Decision decision = Decision::threshold;
  std::optional<double> margin;          ///< X, in score a frame; none: automatic
  std::optional<uint64_t> margin_width;  ///< w; none: half-widths of the training sequences
  /// "A=B": sequences that show the same place. Empty: as found; "none": all differ.
  std::vector<std::string> same_place;
  FilterSettings filter;                ///< of the method filter
  std::optional<double> fusion_weight;  ///< beta, deviations a nat; none: FAB-MAP is not asked
  /// The query against its own past, without a database; what follows is only of these.
  bool loop = false;
  uint64_t loop_gap = 0;   ///< frames that a match lies behind at least; 0: loop_gap_s
  double loop_gap_s = 0;   ///< seconds
  std::string descriptor;  ///< of descriptor_kinds(); empty: ldb, or of arrays vectors
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
  visit("margin_width", settings.margin_width);
  visit("same_place", settings.same_place);
  visit("filter", settings.filter);
  visit("fuse_beta", settings.fusion_weight);
  visit("loop", settings.loop);
  visit("loop_gap", settings.loop_gap);
  visit("loop_gap_s", settings.loop_gap_s);
  visit("descriptor", settings.descriptor);
}

/// The settings of FAB-MAP.
struct FabmapQuerySettings {
  std::string method = "fabmap";
  std::string variant = "fabmap2";
  double place_threshold = 0.99;  ///< t_p: a view is recognized above (strict)
  uint64_t window = 1;            ///< c_w: in so many frames in a row
  WordModel word_model = WordModel::tree;
  NewPlaceModel new_place = NewPlaceModel::pretrain;
  uint64_t new_place_samples = 0;  ///< pretraining frames drawn with the seed; 0: all
  double p_seen_if_there = 0.39;
  double p_seen_if_not = 0;
  int64_t lut_digits = 6;
  bool loop = false;       ///< frames of the query are places for later ones
  uint64_t loop_gap = 10;  ///< but not for so many that follow directly
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

/// The margin, in deviations, from which the method filter accepts: its default.
inline constexpr double kFilterMargin = 3;

/// Throws Error(usage) unless 1 <= c_l <= kMaxWindowLength.
void check_window_length(uint64_t window_length);
/// Throws Error(usage) unless the factor is finite and above 0.
void check_safety_factor(double factor);

/// The scale of t_r: the one that is set, or the score's default; of a sequence against its own
/// past, the scale of single scores, which needs no other window.
ThresholdScale scale_of(const SequenceQuerySettings& settings);

/// The settings as files hold them: the default scale filled in, and those of other scores and
/// decisions left out, as are a margin_width and a same_place that are not set.
Json settings_in_force(const QuerySettings& settings);

/// The name of the method: a row of sequence_methods(), or "fabmap".
const std::string& method_of(const QuerySettings& settings);
/// What the method's scores are.
const ScoreKind& score_of(const QuerySettings& settings);
/// Frames of what is compared: c_l, or 1 for FAB-MAP, which compares frames.
size_t window_length_of(const QuerySettings& settings);

}  // namespace vpr
