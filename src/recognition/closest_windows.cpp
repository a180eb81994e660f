#include "recognition/closest_windows.h"

#include <tuple>
#include <utility>

#include <oneapi/tbb/enumerable_thread_specific.h>

#include "base/step_parts.h"
#include "matching/fastable_batch.h"
#include "matching/standardized_frames.h"
#include "recognition/elsewhere.h"

namespace vpr {
namespace {

void keep_closer(std::optional<ClosestWindows>& kept, const ClosestWindows& candidate) {
  const auto key = [](const ClosestWindows& c) {
    return std::tie(c.score, c.window, c.other_sequence, c.other_window);
  };
  if (!kept || key(candidate) < key(*kept)) kept = candidate;
}

// One sequence as the query. Distances are the same both ways: those to all later sequences serve
// both, and every pair of sequences is met once. Scores are compared with all other sequences.
void compare_with_others(std::span<const DescriptorSpan> sequences, size_t own,
                         const ScoreBasis* basis, const MatchSettings& settings,
                         const Monitor& monitor, ClosestTable& table) {
  std::vector<DescriptorSpan> others(sequences.begin(), sequences.end());
  std::vector<uint8_t> keep(sequences.size(), 1);
  for (size_t s = 0; s <= own; ++s)
    if (s == own || basis == nullptr) {
      others[s] = {};
      keep[s] = 0;
    }
  FrameDistances distances = frame_distances(others, sequences[own]);
  if (basis != nullptr)
    distances = standardized(std::move(distances), basis_of(*basis, sequences, keep), monitor);
  oneapi::tbb::enumerable_thread_specific<ClosestTable> locals(ClosestTable(sequences.size()));
  match_fastable(distances, settings, monitor, [&](const ScoreRow& row) {
    const uint32_t* values = row.scores.data();
    const size_t count = row.scores.size();
    const uint32_t least = settings.kernels.minimum(values, count);
    const auto may_be_closer = [least](const std::optional<ClosestWindows>& kept) {
      return !kept || least <= kept->score;
    };
    std::optional<ClosestWindows>& kept = locals.local()[row.sequence];
    std::optional<ClosestWindows>& kept_of_own = locals.local()[own];
    if (!may_be_closer(kept) && (basis != nullptr || !may_be_closer(kept_of_own))) return;
    const size_t window =
        row.train_window + settings.kernels.find_below(values, 0, count, least + 1);
    keep_closer(kept, {least, window, own, row.query_window});
    if (basis == nullptr) keep_closer(kept_of_own, {least, row.query_window, row.sequence, window});
  });
  for (const ClosestTable& local : locals)
    for (size_t s = 0; s < table.size(); ++s)
      if (local[s]) keep_closer(table[s], *local[s]);
}

std::optional<ClosestWindows> closest_of_own(const DescriptorSpan& walk, const ScoreBasis* basis,
                                             const MatchSettings& settings,
                                             const Monitor& monitor) {
  return closest_elsewhere(
      walk, settings.window_length, settings.kernels,
      [&](const FrameDistances& distances, const RowConsumer& consume) {
        if (basis == nullptr)
          match_fastable(distances, settings, monitor, consume);
        else
          match_fastable(standardized(distances, *basis, monitor), settings, monitor, consume);
      },
      monitor);
}

}  // namespace

ClosestTable find_closest_windows(std::span<const DescriptorSpan> sequences,
                                  const ScoreBasis* basis, const MatchSettings& settings,
                                  const Monitor& monitor) {
  if (sequences.size() == 1) return {closest_of_own(sequences[0], basis, settings, monitor)};
  ClosestTable table(sequences.size());
  // The last sequence has no later one.
  const size_t queries = sequences.size() - (basis == nullptr && !sequences.empty() ? 1 : 0);
  for (size_t own = 0; own < queries; ++own)
    compare_with_others(sequences, own, basis, settings, part_of(monitor, "training", own, queries),
                        table);
  return table;
}

}  // namespace vpr
