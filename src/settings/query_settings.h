// The settings of a query: everything that can change a result. JSON keys are the names of the
// flags. With the table of decisions.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/enum_names.h"
#include "base/json_fwd.h"
#include "match/match.h"
#include "settings/fabmap_settings.h"
#include "settings/scores.h"

namespace vpr {

/// Which recognitions are neighbors.
struct ClusterSettings {
  int64_t eps = 2;            ///< Euclidean, in frames of the (train, query) plane; 0 to kMaxEps
  bool eps_inclusive = true;  ///< a distance of eps is inside (published program: no)
};
/// The largest eps.
inline constexpr int64_t kMaxEps = 1000;

VPR_FIELDS(ClusterSettings, eps, eps_inclusive)

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
  Decision decision = Decision::threshold;
  std::optional<double> margin;              ///< X, in score per frame; nullopt: default_margin
  std::optional<uint64_t> exclusion_frames;  ///< exclusion radius w; nullopt: one per sequence
  /// "A=B": sequences of the same place. Empty: detected; "none": all places differ.
  std::vector<std::string> same_place;
  FilterSettings filter;  ///< for the method filter
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
  visit("decide", settings.decision);
  visit("margin", settings.margin);
  visit("exclusion_frames", settings.exclusion_frames);
  visit("same_place", settings.same_place);
  visit("filter", settings.filter);
  visit("loop", settings.loop);
  visit("loop_gap", settings.loop_gap);
  visit("loop_gap_s", settings.loop_gap_s);
  visit("descriptor", settings.descriptor);
}

/// The settings of any method.
using QuerySettings = std::variant<SequenceQuerySettings, FabmapQuerySettings>;

/// The default margin of the filter, in standard deviations.
inline constexpr double kFilterMargin = 14;

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
/// Whether the method has paths; never for FAB-MAP. Throws Error(usage) for an unknown method.
bool has_paths(const SequenceQuerySettings& settings);
bool has_paths(const QuerySettings& settings);
const ScoreKind& score_of(const QuerySettings& settings);
/// The number of frames of a window: c_l, or 1 for FAB-MAP, which compares frames.
size_t window_length_of(const QuerySettings& settings);

}  // namespace vpr
