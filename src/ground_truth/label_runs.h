// The labels of a query's references as runs: as few as there are, however many the references.
#pragma once

#include <vector>

#include "ground_truth/ground_truth.h"

namespace vpr {

/// A run of references with one label, tolerance applied.
struct LabelRun {
  size_t first = 0;
  size_t last = 0;
  PlaceLabel label = PlaceLabel::same;
};

/// The runs of one query that are not `different`, in order, among the first `frames` references of
/// a sequence. Time linear in the query's pairs of that sequence.
std::vector<LabelRun> label_runs(const GroundTruth& truth, size_t query, size_t sequence,
                                 size_t frames);

}  // namespace vpr
