#include "ground_truth/kept_labels.h"

#include <algorithm>

#include "ground_truth/label_runs.h"

namespace vpr {
namespace {

using Pair = GroundTruth::Pair;

// The kept frame nearest to a run of which none is kept, and behind which `next` is the first.
uint32_t nearest_kept(const std::vector<uint32_t>& sources, const LabelRun& run, size_t next) {
  if (next == sources.size()) return static_cast<uint32_t>(next - 1);
  if (next == 0) return 0;
  const bool is_before = run.first - sources[next - 1] <= sources[next] - run.last;
  return static_cast<uint32_t>(is_before ? next - 1 : next);
}

// The runs of a recording's frames among those that are kept of it.
void add_kept(std::vector<Pair>& row, uint32_t sequence, const std::vector<LabelRun>& runs,
              const std::vector<uint32_t>& sources) {
  for (const LabelRun& run : runs) {
    const auto first = std::ranges::lower_bound(sources, run.first);
    const auto end = std::ranges::upper_bound(sources, run.last);
    const auto index = static_cast<uint32_t>(first - sources.begin());
    if (first != end)
      row.push_back({sequence, index, run.label, static_cast<uint32_t>(end - first - 1)});
    else if (run.label == PlaceLabel::same)
      row.push_back({sequence, nearest_kept(sources, run, index), run.label, 0});
  }
}

// Sorted, no frame twice, and same where it is both.
std::vector<Pair> without_overlaps(std::vector<Pair> row, size_t sequence_frames) {
  GroundTruth one;
  std::sort(row.begin(), row.end());
  one.pairs = {std::move(row)};
  std::vector<Pair> clean;
  if (one.pairs[0].empty()) return clean;
  const uint32_t sequence = one.pairs[0].front().sequence;
  for (const LabelRun& run : label_runs(one, 0, sequence, sequence_frames))
    clean.push_back({sequence, static_cast<uint32_t>(run.first), run.label,
                     static_cast<uint32_t>(run.last - run.first)});
  return clean;
}

}  // namespace

void keep_frames(GroundTruth& truth, const GroundTruthScope& scope) {
  for (size_t query = 0; query < truth.pairs.size(); ++query) {
    std::vector<Pair> kept;
    for (size_t s = 0; s < scope.sequences.size(); ++s) {
      const auto& sequence = scope.sequences[s];
      const size_t recorded = sequence.kept ? sequence.kept->recorded_frames : sequence.frames;
      const auto runs = label_runs(truth, query, s, recorded);
      std::vector<Pair> row;
      if (sequence.kept) {
        add_kept(row, static_cast<uint32_t>(s), runs, sequence.kept->sources);
      } else {
        for (const LabelRun& run : runs)
          row.push_back({static_cast<uint32_t>(s), static_cast<uint32_t>(run.first), run.label,
                         static_cast<uint32_t>(run.last - run.first)});
      }
      row = without_overlaps(std::move(row), sequence.frames);
      kept.insert(kept.end(), row.begin(), row.end());
    }
    truth.pairs[query] = std::move(kept);
  }
  truth.tolerance_frames = 0;
}

}  // namespace vpr
