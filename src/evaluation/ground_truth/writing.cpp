#include "evaluation/ground_truth/writing.h"

#include <fmt/format.h>

#include "base/error.h"

namespace vpr {

std::vector<LabelRun> label_runs(const GroundTruth& truth, size_t query, size_t sequence,
                                 size_t frames) {
  std::vector<PlaceLabel> labels(frames);
  truth.label_row(query, sequence, labels);
  std::vector<LabelRun> runs;
  for (size_t first = 0; first < frames;) {
    size_t end = first + 1;
    while (end < frames && labels[end] == labels[first]) ++end;
    if (labels[first] != PlaceLabel::different) runs.push_back({first, end - 1, labels[first]});
    first = end;
  }
  return runs;
}

size_t only_written_sequence(const InspectedGroundTruth& ground_truth, std::string_view format) {
  size_t searched = 0;
  size_t index = 0;
  const auto& sequences = ground_truth.scope.sequences;
  for (size_t s = 0; s < sequences.size(); ++s) {
    if (!sequences[s].searched) continue;
    ++searched;
    index = s;
  }
  if (searched == 1) return index;
  throw Error(ErrorKind::usage,
              fmt::format("the format {} holds one training sequence, and there are {}; use pairs",
                          format, searched));
}

}  // namespace vpr
