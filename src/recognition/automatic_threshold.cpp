#include "recognition/automatic_threshold.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <oneapi/tbb/enumerable_thread_specific.h>

#include "base/step_parts.h"
#include "matching/distance_statistics.h"
#include "matching/fastable_batch.h"
#include "recognition/elsewhere.h"

namespace vpr {
namespace {

// Of how much windows of c_l frames spread below the typical distance, and below the mean one of
// the query window: c_l independent distances would by 1 / sqrt(c_l). Measured on floors that look
// alike (docs/methods.md).
constexpr double kSpread = 0.65;
constexpr double kMeanSpread = 0.8;

constexpr uint64_t kTypicalSamples = 1000;

// One sequence against all later ones: every pair of sequences is met once.
void compare_with_later(std::span<const DescriptorSpan> sequences, size_t own,
                        const MatchSettings& settings, const Monitor& monitor,
                        ClosestTable& table) {
  const FrameDistances later = frame_distances(sequences.subspan(own + 1), sequences[own]);
  oneapi::tbb::enumerable_thread_specific<ClosestTable> locals(ClosestTable(sequences.size()));
  match_fastable(later, settings, monitor, [&](const DistanceRow& row) {
    const size_t other = own + 1 + row.sequence;
    const uint32_t* distances = row.distances.data();
    const size_t count = row.distances.size();
    const uint32_t least = settings.kernels.minimum(distances, count);
    ClosestTable& local = locals.local();
    if (local[own] && local[other] && least > local[own]->distance &&
        least > local[other]->distance)
      return;
    const size_t window =
        row.train_window + settings.kernels.find_below(distances, 0, count, least + 1);
    keep_closer(local[own], {least, row.query_window, other, window});
    keep_closer(local[other], {least, window, own, row.query_window});
  });
  for (const ClosestTable& local : locals)
    for (size_t s = 0; s < table.size(); ++s)
      if (local[s]) keep_closer(table[s], *local[s]);
}

std::optional<ClosestWindows> closest_of_own(const DescriptorSpan& walk,
                                             const MatchSettings& settings,
                                             const Monitor& monitor) {
  return closest_elsewhere(
      walk, settings.window_length, settings.kernels,
      [&](const FrameDistances& distances, const RowConsumer& consume) {
        match_fastable(distances, settings, monitor, consume);
      },
      monitor);
}

}  // namespace

void keep_closer(std::optional<ClosestWindows>& kept, const ClosestWindows& candidate) {
  const auto key = [](const ClosestWindows& c) {
    return std::tie(c.distance, c.window, c.other_sequence, c.other_window);
  };
  if (!kept || key(candidate) < key(*kept)) kept = candidate;
}

ClosestTable find_closest_windows(std::span<const DescriptorSpan> sequences,
                                  const MatchSettings& settings, const Monitor& monitor) {
  if (sequences.size() == 1) return {closest_of_own(sequences[0], settings, monitor)};
  ClosestTable table(sequences.size());
  for (size_t own = 0; own + 1 < sequences.size(); ++own)
    compare_with_later(sequences, own, settings,
                       part_of(monitor, "training", own, sequences.size() - 1), table);
  return table;
}

double largest_threshold(double typical_distance, size_t window_length) {
  return (1 - kSpread / std::sqrt(static_cast<double>(window_length))) * typical_distance;
}

AutomaticThreshold automatic_threshold(const std::optional<ClosestWindows>& closest,
                                       double typical_distance, size_t window_length,
                                       double safety_factor) {
  const double most = largest_threshold(typical_distance, window_length);
  const double found =
      closest ? static_cast<double>(closest->distance) / static_cast<double>(window_length) : most;
  return {std::min(found, most) * safety_factor, ThresholdScale::bits, !closest || most < found};
}

AutomaticThreshold own_threshold(const std::optional<ClosestWindows>& closest,
                                 double typical_distance, size_t window_length,
                                 double safety_factor) {
  const auto length = static_cast<double>(window_length);
  const double most = std::max(0.0, 1 - kMeanSpread / std::sqrt(length));
  const double found = closest && typical_distance > 0
                           ? static_cast<double>(closest->distance) / length / typical_distance
                           : most;
  return {std::min(found, most) * safety_factor, ThresholdScale::mean, !closest || most < found};
}

double typical_distance(const DescriptorSpan& sequence, const Monitor& monitor) {
  StatisticsSettings settings;
  settings.samples = kTypicalSamples;
  return compute_statistics({&sequence, 1}, settings, monitor).typical_distance;
}

}  // namespace vpr
