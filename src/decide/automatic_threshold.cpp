#include "decide/automatic_threshold.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include <oneapi/tbb/enumerable_thread_specific.h>

#include "base/monitor.h"
#include "match/distance_statistics.h"
#include "match/match.h"

namespace vpr {

namespace {

// How far the closest windows of c_l frames are below the typical distance. Independent distances
// would be by 1 / sqrt(c_l). Measured on floors that look alike (docs/methods.md).
constexpr double kSpread = 0.65;

constexpr uint64_t kTypicalSamples = 1000;

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
  const auto find_closer = [&](const ScoreRow& row) {
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
  };
  match(frame_distances(later, sequences[own]), settings, {{find_closer}}, monitor);
  for (const ClosestTable& local : locals)
    for (size_t s = 0; s < table.size(); ++s)
      if (local[s]) keep_closer(table[s], *local[s]);
}

}  // namespace

double largest_threshold(double typical_distance, size_t window_length) {
  return (1 - kSpread / std::sqrt(static_cast<double>(window_length))) * typical_distance;
}

AutomaticThreshold automatic_threshold(const std::optional<ClosestWindows>& closest,
                                       double typical_distance, size_t window_length,
                                       double safety_factor) {
  const double most = largest_threshold(typical_distance, window_length);
  const double found =
      closest ? static_cast<double>(closest->score) / static_cast<double>(window_length) : most;
  return {std::min(found, most) * safety_factor, !closest || most < found};
}

double typical_distance(const DescriptorSpan& sequence, const Monitor& monitor) {
  StatisticsSettings settings;
  settings.samples = kTypicalSamples;
  return compute_statistics({&sequence, 1}, settings, monitor).typical_distance;
}

ClosestTable find_closest_windows(std::span<const DescriptorSpan> sequences,
                                  const MatchSettings& settings, const Monitor& monitor) {
  ClosestTable table(sequences.size());
  for (size_t own = 0; own + 1 < sequences.size(); ++own)
    compare_with_later(sequences, own, settings,
                       part_of(monitor, "training", own, sequences.size() - 1), table);
  return table;
}

}  // namespace vpr
