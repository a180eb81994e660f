// Sweeps: counts for a grid of settings in about the time of one query, and the recommended
// setting.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/enum_names.h"
#include "base/monitor.h"
#include "base/statistics.h"
#include "evaluate/evaluation.h"
#include "evaluate/metrics.h"
#include "evaluate/outcomes.h"
#include "fabmap/place_query.h"
#include "query/exclusion_zones.h"
#include "query/run_query.h"
#include "truth/ground_truth.h"

namespace vpr {

/// A query with ground truth, described for a database of sequences or of FAB-MAP.
template <class Frames>
struct Labeled {
  std::string name;
  Frames frames;
  EvaluationSettings by;
};
using LabeledQuery = Labeled<DescriptorSet>;
using LabeledWords = Labeled<SequenceWords>;

/// Windows by thresholds, at least one each: c_l and t_r or margins, or c_w and t_p.
struct Grid {
  std::vector<uint64_t> windows;
  std::vector<std::optional<double>> thresholds;  ///< nullopt: automatic, never for FAB-MAP
};

/// The settings of a cell: `base` with its c_l and its t_r or margin, by the decision of `base`, or
/// with its c_w and t_p. Cells are by window, then threshold.
SequenceQuerySettings settings_at(const Grid& grid, size_t cell, SequenceQuerySettings base);
FabmapQuerySettings settings_at(const Grid& grid, size_t cell, FabmapQuerySettings base);

/// The margins of query windows if neither their place nor its surroundings were trained. The
/// matches that they belong to are all incorrect. Takes rows as MarginScan does. Windows are judged
/// at their anchors; the surroundings are the frames within the exclusion radius of a frame labeled
/// same or ignore.
class UnknownPlaceScan {
 public:
  /// `truth` and `zones` must outlive the scan.
  UnknownPlaceScan(const GroundTruth& truth, const ExclusionZones& zones, size_t window_length,
                   size_t query_windows)
      : truth_(truth),
        zones_(zones),
        window_length_(window_length),
        untrained_(zones, query_windows) {}
  void operator()(std::span<const ScoreRow> row);
  /// One per query window; unset without a runner-up.
  std::vector<std::optional<uint32_t>> result() const { return untrained_.result(); }

 private:
  const GroundTruth& truth_;
  const ExclusionZones& zones_;
  size_t window_length_;
  MarginScan untrained_;
};

/// One setting of a grid and its counts.
struct CellCounts {
  uint64_t window = 0;                  ///< c_l or c_w
  std::optional<double> threshold;      ///< t_r, a margin or t_p; unset: automatic
  std::optional<ThresholdScale> scale;  ///< of t_r
  Counts counts;
  /// For margins: query windows that are recognized even if their place is not trained
  /// (UnknownPlaceScan).
  std::optional<uint64_t> unknown_place = {};
  Localization path = {};  ///< frames by their best recognitions
};

/// The index of the best counts: among those with at most `max_incorrect` incorrect frames and
/// pairs, the most correct frames, then the fewest incorrect ones; if there are none, the fewest
/// incorrect frames and pairs, then the most correct frames. Ties to the first; `counts` must not
/// be empty.
size_t best_counts(std::span<const FrameCounts> counts, uint64_t max_incorrect);

/// A larger value accepts more: t_r, or the negative of t_p or a margin. Unset: automatic.
std::optional<double> looseness_of(const CellCounts& cell, ScoreOrder order);

/// The conclusion from a grid.
enum class Advice {
  recommended,
  no_recognitions,          ///< every setting is too strict, or the place is unknown
  no_correct_recognitions,  ///< all recognitions are incorrect
  always_errors,            ///< every setting with a correct recognition also has an incorrect one
  next_errs,                ///< the looser neighbor of each error-free setting has an error
  grid_ends,                ///< the looser neighbor of an error-free setting is not in the grid
  only_automatic            ///< automatic thresholds have no looser neighbor
};

template <>
inline constexpr std::array<std::string_view, 7> kEnumNames<Advice> = {
    "recommended", "no_recognitions", "no_correct_recognitions", "always_errors",
    "next_errs",   "grid_ends",       "only_automatic"};

/// The recommended setting, or the reason why there is none. An error is an incorrect recognition,
/// or a window counted as `unknown_place`.
struct Recommendation {
  Advice advice = Advice::no_recognitions;
  /// The cell with the most correct recognitions, ties to the shortest window, then to the
  /// strictest threshold, such that its threshold and all stricter ones of the same window have no
  /// error. Unless `unknown_place` is known, the next looser one must be in the grid and have none.
  /// Cells with an automatic threshold are skipped.
  std::optional<size_t> cell;
  /// For the advice next_errs or grid_ends: the cell to which only the looser neighbor is missing.
  std::optional<size_t> near_miss;
  /// The strictest threshold with an error, for the window of `cell` or `near_miss`.
  std::optional<size_t> first_error;
  /// Cells to which no other cell is superior in correct and incorrect recognitions.
  std::vector<size_t> pareto;
};

/// The cells may have any order. Counts recognitions, not clusters: as a threshold is loosened,
/// both numbers of recognitions can only grow, but incorrect clusters can merge with correct ones.
Recommendation recommend(std::span<const CellCounts> cells, ScoreOrder order);

/// 95 % intervals of the counts of the recommended setting.
struct SweepIntervals {
  size_t block = 1;  ///< frames that are drawn together
  Interval correct_recognitions;
  Interval incorrect_recognitions;
  Interval correct_clusters = {};  ///< without FAB-MAP; a cluster counts at its mean query window
  Interval incorrect_clusters = {};
};

/// The recommended setting on another query.
struct ValidatedCell {
  std::string query_name;
  CellCounts cell;
};

/// The sweep of one query, with at least one cell.
struct Sweep {
  Sequence query;
  const ScoreKind* score = &score_kind(Score::raw);
  std::string threshold_symbol = "t_r";               ///< t_r, t_p or a margin
  ScoreOrder threshold_order = ScoreOrder::distance;  ///< distance: larger values accept more
  Grid grid;
  std::vector<CellCounts> cells;  ///< by window, then threshold
  Recommendation recommendation;
  std::optional<QuerySettings> recommended_settings;
  std::optional<SweepIntervals> intervals;
  std::optional<ValidatedCell> validation;
  std::string protocol;                     ///< a description of the ground truth
  std::optional<Localization> filter = {};  ///< frames that the method filter recognizes
  std::string advice = {};                  ///< filter_advice, if these are none
};

/// 95 % intervals of the recognitions and clusters of a result, by the block bootstrap over query
/// windows. Blocks have c_l windows, because neighbors share most of their frames; for FAB-MAP they
/// have c_w frames, at least 8.
SweepIntervals count_intervals(const Result& result, const GroundTruth& truth, uint64_t seed);

/// The counts of vpr-query and vpr-eval for every cell, by window, then threshold, and the
/// recommended cell. Frame distances are computed once (twice for thresholds relative to the
/// largest distance): windows of all lengths come from the same pass, and the thresholds of one
/// length from its recognitions at the largest one. `base`: the other settings. Each warning is
/// reported once. Throws as plan_query and whole_truth_of do, and Error(usage) if the recognitions
/// of all lengths together exceed the memory limit.
Sweep sweep_sequences(const SequenceDatabase& database, const LabeledQuery& query,
                      const SequenceQuerySettings& base, const Grid& grid,
                      const QueryResources& resources, const Monitor& monitor);

/// The counts for FAB-MAP, from one pass of posteriors. Throws Error(usage) for settings out of
/// range and loop queries; also throws what whole_truth_of throws.
Sweep sweep_fabmap(const FabmapDatabase& database, const LabeledWords& query,
                   const FabmapQuerySettings& base, const Grid& grid, uint64_t seed,
                   const Monitor& monitor);

}  // namespace vpr
