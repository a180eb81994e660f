// Counts over a grid of settings, and which setting to choose.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/enum_names.h"
#include "base/statistics.h"
#include "evaluate/counts.h"

namespace vpr {

/// One setting of a grid, and what it gives.
struct CellCounts {
  uint64_t window = 0;                  ///< c_l or c_w
  std::optional<double> threshold;      ///< t_r, a margin or t_p; none: automatic
  std::optional<ThresholdScale> scale;  ///< of t_r; none of others
  Counts counts;
  /// Of margins: query windows that would be recognitions were their own place not trained, wrong
  /// ones for sure. None: not known.
  std::optional<uint64_t> untrained = {};
};

/// Accepts more where it is larger: a t_r, or the negative of a t_p or a margin. None: automatic.
std::optional<double> looseness_of(const CellCounts& cell, ScoreOrder order);

/// What a grid allows to say.
enum class Advice {
  recommended,
  no_recognitions,          ///< every setting is too strict, or the place is not known
  no_correct_recognitions,  ///< recognitions, but only incorrect ones
  always_errors,            ///< every setting with a correct recognition has an incorrect one, too
  next_errs,                ///< settings without an error, but the next looser threshold has one
  grid_ends,      ///< settings without an error, but the next looser threshold is not in the grid
  only_automatic  ///< automatic thresholds have no order, and so no next looser one
};

template <>
inline constexpr std::array<std::string_view, 7> kEnumNames<Advice> = {
    "recommended", "no_recognitions", "no_correct_recognitions", "always_errors",
    "next_errs",   "grid_ends",       "only_automatic"};

/// The setting to take, or why there is none.
struct Recommendation {
  Advice advice = Advice::no_recognitions;
  /// The cell with most correct recognitions among those whose threshold, every stricter and the
  /// next looser one of the same window have no incorrect recognition; of equals the one with the
  /// shortest window, then the strictest threshold. The next looser one must be in the grid: a
  /// setting that nobody has looked beyond is not recommended. Where it is known what windows would
  /// reach were their place not trained, these count as incorrect recognitions, and the next looser
  /// threshold does not matter. Cells with an automatic threshold are passed over.
  std::optional<size_t> cell;
  /// The error-free cell with most correct recognitions, where it lacks only an error-free
  /// neighbor: advice next_errs or grid_ends.
  std::optional<size_t> near_miss;
  /// Of the window of `cell` or `near_miss`: the strictest threshold with an incorrect recognition,
  /// or one that would be without its place. None: no threshold of this window in the grid has one.
  std::optional<size_t> first_error;
  std::vector<size_t>
      pareto;  ///< cells that no other beats in both correct and incorrect recognitions
};

/// Chooses among the cells of a grid, which may be in any order. Only recognitions count, never
/// clusters: as a threshold is loosened, recognitions and incorrect recognitions only become more,
/// but clusters merge, and an incorrect one vanishes in a correct one.
Recommendation recommend(std::span<const CellCounts> cells, ScoreOrder order);

/// What is known of the uncertainty of the recommended setting: 95 % intervals of its counts.
struct SweepIntervals {
  size_t block = 1;  ///< frames that are drawn together
  Interval correct_recognitions;
  Interval incorrect_recognitions;
  Interval correct_places = {};  ///< of sequences; a place counts at its mean query window
  Interval incorrect_places = {};
};

/// The recommended setting on another query.
struct ValidatedCell {
  std::string query_name;
  CellCounts cell;
};

/// One query's sweep, which has a cell.
struct Sweep {
  Sequence query;
  const ScoreKind* score = &score_kind(Score::raw);
  std::string threshold_symbol = "t_r";               ///< what is swept beside the window: or t_p,
                                                      ///< or a margin
  ScoreOrder threshold_order = ScoreOrder::distance;  ///< distance: a larger one accepts more
  std::vector<CellCounts> cells;                      ///< by window, then threshold
  Recommendation recommendation;
  std::optional<QuerySettings> recommended_settings;
  std::optional<SweepIntervals> intervals;
  std::optional<ValidatedCell> validation;
  std::string protocol;  ///< of the ground truth, in words
};

}  // namespace vpr
