// What writers of ground truth share.
#pragma once

#include <string_view>

#include "base/error.h"
#include "evaluation/ground_truth.h"

namespace vpr {

/// A run of references with one label, tolerance applied.
struct LabelRun {
  size_t first = 0;
  size_t last = 0;
  PlaceLabel label = PlaceLabel::same;
};

/// The runs of one query that are not `different`, in order.
std::vector<LabelRun> label_runs(const GroundTruth& truth, size_t query, size_t sequence,
                                 size_t frames);

/// The index of the one sequence that was searched. Throws Error(usage) if there are more, or none.
size_t only_written_sequence(const InspectedGroundTruth& ground_truth, std::string_view format);

}  // namespace vpr
