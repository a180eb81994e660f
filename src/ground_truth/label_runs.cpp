#include "ground_truth/label_runs.h"

#include <algorithm>
#include <span>

namespace vpr {
namespace {

// Behind what is there, or as its end.
void append(std::vector<LabelRun>& runs, const LabelRun& run) {
  if (!runs.empty() && runs.back().label == run.label && run.first <= runs.back().last + 1)
    runs.back().last = std::max(runs.back().last, run.last);
  else
    runs.push_back(run);
}

// Runs of one label, each `reach` frames longer at both ends, cut off at the sequence's.
std::vector<LabelRun> widened_runs(std::span<const GroundTruth::Pair> pairs, size_t frames,
                                   PlaceLabel label, int64_t reach) {
  std::vector<LabelRun> runs;
  for (const GroundTruth::Pair& pair : pairs) {
    if (pair.label != label) continue;
    const int64_t first = std::max<int64_t>(0, pair.first - reach);
    const int64_t end = std::min(static_cast<int64_t>(frames), pair.last() + reach + 1);
    if (first < end)
      append(runs, {static_cast<size_t>(first), static_cast<size_t>(end - 1), label});
  }
  return runs;
}

}  // namespace

std::vector<LabelRun> label_runs(const GroundTruth& truth, size_t query, size_t sequence,
                                 size_t frames) {
  const auto pairs = truth.pairs_of(query, sequence);
  const auto same = widened_runs(pairs, frames, PlaceLabel::same, truth.tolerance_frames);
  std::vector<LabelRun> runs;
  auto next = same.begin();
  size_t free = 0;  // behind the runs that are there already, which win
  for (const LabelRun& ignored : widened_runs(pairs, frames, PlaceLabel::ignore, 0)) {
    for (; next != same.end() && next->first <= ignored.last; ++next) {
      const size_t first = std::max(ignored.first, free);
      if (first < next->first) append(runs, {first, next->first - 1, ignored.label});
      append(runs, *next);
      free = next->last + 1;
    }
    const size_t first = std::max(ignored.first, free);
    if (first <= ignored.last) append(runs, {first, ignored.last, ignored.label});
  }
  for (; next != same.end(); ++next) append(runs, *next);
  return runs;
}

}  // namespace vpr
