#include "recognition/closest_windows.h"

#include <tuple>
#include <utility>

#include <oneapi/tbb/enumerable_thread_specific.h>

#include "base/monitor.h"
#include "matching/fastable_batch.h"

namespace vpr {
namespace {

void keep_closer(std::optional<ClosestWindows>& kept, const ClosestWindows& candidate) {
  const auto key = [](const ClosestWindows& c) {
    return std::tie(c.score, c.window, c.other_sequence, c.other_window);
  };
  if (!kept || key(candidate) < key(*kept)) kept = candidate;
}

// One sequence as the query of all later ones. Distances are symmetric: every pair of sequences is
// compared once.
void compare_with_later(std::span<const DescriptorSpan> sequences, size_t own,
                        const MatchSettings& settings, const Monitor& monitor,
                        ClosestTable& table) {
  std::vector<DescriptorSpan> later(sequences.begin(), sequences.end());
  for (size_t s = 0; s <= own; ++s) later[s] = {};
  oneapi::tbb::enumerable_thread_specific<ClosestTable> locals(ClosestTable(sequences.size()));
  match_fastable(frame_distances(later, sequences[own]), settings, monitor,
                 [&](const ScoreRow& row) {
                   const uint32_t* values = row.scores.data();
                   const size_t count = row.scores.size();
                   const uint32_t least = settings.kernels.minimum(values, count);
                   const auto may_be_closer = [least](const std::optional<ClosestWindows>& kept) {
                     return !kept || least <= kept->score;
                   };
                   std::optional<ClosestWindows>& kept = locals.local()[row.sequence];
                   std::optional<ClosestWindows>& kept_of_own = locals.local()[own];
                   if (!may_be_closer(kept) && !may_be_closer(kept_of_own)) return;
                   const size_t window =
                       row.train_window + settings.kernels.find_below(values, 0, count, least + 1);
                   keep_closer(kept, {least, window, own, row.query_window});
                   keep_closer(kept_of_own, {least, row.query_window, row.sequence, window});
                 });
  for (const ClosestTable& local : locals)
    for (size_t s = 0; s < table.size(); ++s)
      if (local[s]) keep_closer(table[s], *local[s]);
}

}  // namespace

ClosestTable find_closest_windows(std::span<const DescriptorSpan> sequences,
                                  const MatchSettings& settings, const Monitor& monitor) {
  ClosestTable table(sequences.size());
  for (size_t own = 0; own + 1 < sequences.size(); ++own)
    compare_with_later(sequences, own, settings,
                       part_of(monitor, "training", own, sequences.size() - 1), table);
  return table;
}

}  // namespace vpr
