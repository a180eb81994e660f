#include "recognition/automatic_threshold.h"

#include <algorithm>
#include <set>
#include <tuple>

#include <fmt/format.h>
#include <oneapi/tbb/enumerable_thread_specific.h>

#include "base/statistics.h"
#include "matching/fastable_batch.h"

namespace vpr {
namespace {

// Windows of different places differ by more, whatever the median of all sequences is: a tenth of
// the bits of a frame.
constexpr double kSamePlaceBits = kLdbBits / 10.0;

using ClosestTable = std::vector<std::optional<ClosestWindows>>;

void keep_closer(std::optional<ClosestWindows>& kept, const ClosestWindows& candidate) {
  const auto key = [](const ClosestWindows& c) {
    return std::tie(c.distance, c.window, c.other_sequence, c.other_window);
  };
  if (!kept || key(candidate) < key(*kept)) kept = candidate;
}

// One sequence against all later ones: every pair of sequences is met once.
void compare_with_later(std::span<const CodeSpan> sequences, size_t own,
                        const MatchSettings& settings, const Monitor& monitor,
                        ClosestTable& table) {
  const TrainCodes later = make_train_codes(sequences.subspan(own + 1));
  const QueryCodes query = make_query_codes(sequences[own]);
  oneapi::tbb::enumerable_thread_specific<ClosestTable> locals(ClosestTable(sequences.size()));
  match_fastable(later, query, settings, monitor, [&](const DistanceRow& row) {
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

std::string window_text(const ThresholdTable& table, std::span<const TrainSequence> sequences,
                        size_t sequence, size_t window) {
  const size_t last = window + table.window_length - 1;
  return fmt::format("{} frames {} to {} ({} to {})", sequences[sequence].name, window, last,
                     sequences[sequence].frame_names[window],
                     sequences[sequence].frame_names[last]);
}

}  // namespace

ClosestTable find_closest_windows(std::span<const CodeSpan> sequences,
                                  const MatchSettings& settings, const Monitor& monitor) {
  ClosestTable table(sequences.size());
  for (size_t own = 0; own + 1 < sequences.size(); ++own)
    compare_with_later(sequences, own, settings, monitor, table);
  return table;
}

double automatic_threshold(const ClosestWindows& closest, size_t window_length,
                           double safety_factor) {
  return static_cast<double>(closest.distance) / static_cast<double>(window_length) * safety_factor;
}

std::vector<std::string> overlap_warnings(const ThresholdTable& table,
                                          std::span<const TrainSequence> sequences) {
  std::vector<double> distances;
  for (const auto& closest : table.closest)
    if (closest) distances.push_back(closest->distance);
  std::vector<std::string> warnings;
  if (distances.empty()) return warnings;
  const double middle = median(distances);
  std::set<std::pair<size_t, size_t>> named;
  for (size_t s = 0; s < table.closest.size(); ++s) {
    const auto& closest = table.closest[s];
    if (!closest) continue;
    const double bits =
        static_cast<double>(closest->distance) / static_cast<double>(table.window_length);
    if (closest->distance >= middle / 2 && bits >= kSamePlaceBits) continue;
    if (!named.insert(std::minmax(s, closest->other_sequence)).second) continue;
    warnings.push_back(fmt::format(
        "the training sequences {} and {} may show the same place, which makes their automatic "
        "t_r too small ({:.1f} bits at c_l {}, median {:.1f}): compare {} with {}",
        sequences[s].name, sequences[closest->other_sequence].name,
        automatic_threshold(*closest, table.window_length, table.safety_factor),
        table.window_length,
        middle / static_cast<double>(table.window_length) * table.safety_factor,
        window_text(table, sequences, s, closest->window),
        window_text(table, sequences, closest->other_sequence, closest->other_window)));
  }
  return warnings;
}

}  // namespace vpr
