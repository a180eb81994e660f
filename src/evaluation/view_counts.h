// The counts of a result by view: a stop of either walk is one observation, however many frames it
// has.
#pragma once

#include <cstdint>
#include <optional>

#include "ground_truth/ground_truth.h"
#include "recognition/result.h"

namespace vpr {

/// Views, or pairs of views, by what their frames are.
struct ViewCounts {
  uint64_t correct = 0;    ///< all are correct
  uint64_t incorrect = 0;  ///< all are incorrect
  uint64_t mixed = 0;      ///< some are correct and some are not
  uint64_t ignored = 0;    ///< all are ignored, which otherwise count for nothing
};

/// Counts in which every view counts once, however many frames show it.
struct CountsByView {
  size_t query_views = 0;
  size_t train_views = 0;    ///< of the searched sequences
  ViewCounts hits;           ///< pairs of a query view and a training view that have hits
  ViewCounts best_match;     ///< query views that have windows with a match
  double correct_share = 0;  ///< summed over these, of their windows that are right

  /// The rate of best matches where every view counts as much as any other; none without one.
  std::optional<double> best_match_rate() const;
};

/// Windows belong to the views of their anchors, and are judged there. Nothing for a result that
/// does not say where its views begin.
std::optional<CountsByView> count_by_view(const Result& result, const GroundTruth& truth,
                                          const Monitor& monitor = {});

}  // namespace vpr
