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
#include "database/keyframe_features.h"
#include "match/match.h"
#include "query/fabmap_settings.h"
#include "query/scores.h"

namespace vpr {

/// Which recognitions are neighbors.
struct ClusterSettings {
  int64_t eps = 2;            ///< Euclidean, in frames of the (train, query) plane; 0 to kMaxEps
  bool eps_inclusive = true;  ///< a distance of eps is inside (published program: no)
};
/// The largest eps.
inline constexpr int64_t kMaxEps = 1000;

VPR_FIELDS(ClusterSettings,
           (eps, "Largest Euclidean distance of neighboring recognitions, in frames.",
            within(0, kMaxEps)),
           (eps_inclusive, "Whether a distance of eps joins."))

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
};

const DecisionKind& decision_kind(Decision decision);

/// Windows of c_l frames, each with the scores of all pairs.
struct WindowSettings {
  std::string method = "fastable";  ///< of exact_methods()
  uint64_t window_length = 40;      ///< c_l
  Score score = Score::raw;
  std::optional<uint64_t> exclusion_frames = {};  ///< exclusion radius w; nullopt: automatic
  /// "A=B": sequences of the same place. Empty: detected; "none": all places differ.
  std::vector<std::string> same_place = {};
};

/// Recognizes every window pair with a score below t_r.
struct Threshold {
  WindowSettings windows = {};
  std::optional<double> threshold = {};  ///< t_r; nullopt: automatic, for loops best matches only
  /// The scale of a t_r that is a number; automatic ones are in bits. Nullopt: the default of the
  /// score (scale_of).
  std::optional<ThresholdScale> scale = {};
  std::optional<double> safety_factor = {};  ///< of automatic t_r; nullopt: the database's
};

/// Recognizes the best match of a query window if its margin is at least X.
struct Margin {
  WindowSettings windows = {};
  std::optional<double> margin = {};  ///< X, in score per frame; nullopt: default_margin
};

/// The default margin of the filter, in standard deviations.
inline constexpr double kFilterMargin = 14;

/// Recognizes the matches of paths over z-scores of frames.
struct Filter {
  double margin = kFilterMargin;  ///< of a path, in standard deviations
  FilterSettings settings = {};
  std::vector<std::string> same_place = {};  ///< as for windows
  Witness witness = Witness::orb;  ///< adds evidence to margins if the database has features
};

/// Recognizes window pairs below t_r among those that share a bucket of hash tables.
struct Lsh {
  uint64_t window_length = 40;               ///< c_l
  std::optional<double> threshold = {};      ///< t_r in bits; nullopt: automatic
  std::optional<double> safety_factor = {};  ///< of automatic t_r; nullopt: the database's
  LshSettings settings = {};
};

/// Scores and decisions of a query by a sequence method. An impossible combination has no field.
using Rule = std::variant<Threshold, Margin, Filter, Lsh>;

/// The query as its own training sequence: each frame is matched with earlier ones.
struct OwnPast {
  /// The minimum distance between a frame and its match, in frames or in seconds.
  std::variant<uint64_t, double> gap = uint64_t{0};
  std::string descriptor = {};  ///< of descriptor_kinds(); empty: ldb, or vectors for arrays
};

/// A query by a sequence method: FastABLE, OpenABLE, LSH, the filter.
struct SequenceQuerySettings {
  Rule rule = {};
  std::vector<std::string> only_sequences = {};  ///< training sequences to search; empty: all
  bool skip_unreadable = false;
  ClusterSettings clustering = {};
  std::optional<OwnPast> past = {};  ///< of a loop query, which has no database
};

/// Every key of a sequence query once, as flags and files set them before they are a rule. Keys are
/// the names of the flags.
struct SequenceKeys {
  Threshold windows = {};  ///< the method is any; c_l, the score and t_r are also those of others
  Decision decision = Decision::threshold;
  std::optional<double> margin = {};
  LshSettings lsh = {};
  FilterSettings filter = {};
  Witness witness = Witness::orb;
  std::vector<std::string> only_sequences = {};
  bool skip_unreadable = false;
  ClusterSettings clustering = {};
  bool loop = false;
  uint64_t loop_gap = 0;  ///< in frames; 0: loop_gap_s
  double loop_gap_s = 0;  ///< in seconds
  std::string descriptor = {};
};

template <class Visitor>
void visit_fields(SequenceKeys& keys, Visitor&& visit) {
  visit("method", keys.windows.windows.method, "Matching method; default: the database's.");
  visit("c_l", keys.windows.windows.window_length, "", at_least(1));
  visit("t_r", keys.windows.threshold, "", kMayBeMissing);
  visit("t_r_scale", keys.windows.scale, "", kMayBeMissing);
  visit("safety_factor", keys.windows.safety_factor, "", kMayBeMissing);
  visit("only_sequence", keys.only_sequences);
  visit("skip_unreadable", keys.skip_unreadable);
  visit("clustering", keys.clustering, "How recognitions are joined into recognized places.");
  visit("lsh", keys.lsh, "Settings of method lsh.", kMayBeMissing);
  visit("score", keys.windows.windows.score);
  visit("decide", keys.decision);
  visit("margin", keys.margin, "", kMayBeMissing);
  visit("exclusion_frames", keys.windows.windows.exclusion_frames, "", kMayBeMissing);
  visit("same_place", keys.windows.windows.same_place, "", kMayBeMissing);
  visit("filter", keys.filter, "Settings of method filter.", kMayBeMissing);
  visit("witness", keys.witness, "", kMayBeMissing);
  visit("loop", keys.loop,
        "Match the query with its own past; in FAB-MAP, frames become places for later frames.");
  visit("loop_gap", keys.loop_gap, "Frames between a frame and its match at least; 0: loop_gap_s.",
        kMayBeMissing);
  visit("loop_gap_s", keys.loop_gap_s, "Least gap, in seconds.", kMayBeMissing);
  visit("descriptor", keys.descriptor, "", kMayBeMissing);
}

/// The settings of any method.
using QuerySettings = std::variant<SequenceQuerySettings, FabmapQuerySettings>;

/// Throws Error(usage) unless 1 <= c_l <= kMaxWindowLength.
void check_window_length(uint64_t window_length);
/// Throws Error(usage) unless the factor is finite and above 0.
void check_safety_factor(double factor);

/// The windows of a threshold or a margin; null for other rules.
const WindowSettings* windows_of(const Rule& rule);
/// An entry of sequence_methods().
const std::string& method_of(const Rule& rule);
/// c_l, or 1 for the filter, which compares frames.
uint64_t window_length_of(const Rule& rule);
Score score_of(const Rule& rule);
Decision decision_of(const Rule& rule);
/// t_r or the margin; nullopt: automatic.
std::optional<double> limit_of(const Rule& rule);
/// Sets it; for the filter, nullopt is its default margin.
void set_limit(Rule& rule, std::optional<double> limit);
const std::vector<std::string>& same_place_of(const Rule& rule);
bool has_paths(const Rule& rule);
bool is_zscore(const Rule& rule);

/// The scale of t_r: the setting, or else the score's default; nullopt for margins. Loop queries
/// use the scale of single scores by default, which needs no other window.
std::optional<ThresholdScale> scale_of(const SequenceQuerySettings& settings);
/// Whether the settings search this training sequence.
bool is_searched(const SequenceQuerySettings& settings, const std::string& sequence);
/// The exclusion radius of windows: the setting, or the gap of a loop query in frames.
std::optional<uint64_t> exclusion_frames_of(const SequenceQuerySettings& settings);
/// Whether t_r is computed from the training sequences.
bool has_automatic_threshold(const SequenceQuerySettings& settings);

/// The settings as in files, defaults included: the keys of the rule in force.
Json settings_in_force(const QuerySettings& settings);
/// The keys of a query, with the values that its rule implies.
SequenceKeys keys_of(const SequenceQuerySettings& settings);
/// The query of keys, unchecked. Keys that its rule does not have are ignored.
SequenceQuerySettings query_of(const SequenceKeys& keys);

/// The name of the method: an entry of sequence_methods(), or "fabmap".
const std::string& method_of(const QuerySettings& settings);
/// Whether the method has paths; never for FAB-MAP.
bool has_paths(const QuerySettings& settings);
const ScoreKind& score_of(const QuerySettings& settings);
/// Whether frames are matched with earlier frames of the query.
bool is_loop(const QuerySettings& settings);
/// The number of frames of a window: c_l, or 1 for FAB-MAP, which compares frames.
size_t window_length_of(const QuerySettings& settings);

}  // namespace vpr
