#include "query/thresholds.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/enumerable_thread_specific.h>

#include "base/error.h"
#include "base/text.h"
#include "match/distance_statistics.h"
#include "match/match.h"
#include "match/row_kernels.h"

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
void compare_with_later(std::span<const DescribedFrames> sequences, size_t own,
                        const MatchSettings& settings, const Monitor& monitor,
                        ClosestTable& table) {
  std::vector<DescribedFrames> later(sequences.begin(), sequences.end());
  for (size_t s = 0; s <= own; ++s) later[s] = {};
  oneapi::tbb::enumerable_thread_specific<ClosestTable> locals(ClosestTable(sequences.size()));
  const auto find_closer = [&](const ScoreRow& row) {
    const uint32_t least = minimum_of(row.scores);
    const auto may_be_closer = [least](const std::optional<ClosestWindows>& kept) {
      return !kept || least <= kept->score;
    };
    std::optional<ClosestWindows>& kept = locals.local()[row.sequence];
    std::optional<ClosestWindows>& kept_of_own = locals.local()[own];
    if (!may_be_closer(kept) && !may_be_closer(kept_of_own)) return;
    const size_t window = row.train_window + find_below(row.scores, 0, least + 1);
    keep_closer(kept, {least, window, own, row.query_window});
    keep_closer(kept_of_own, {least, row.query_window, row.sequence, window});
  };
  match(frame_distances(later, sequences[own]), settings, {{find_closer}}, monitor);
  for (const ClosestTable& local : locals)
    for (size_t s = 0; s < table.size(); ++s)
      if (local[s]) keep_closer(table[s], *local[s]);
}

std::string window_text(const Sequence& sequence, size_t window, size_t length) {
  const size_t last = window + length - 1;
  return fmt::format("frames {} to {} ({} to {})", window, last, sequence.frame_names[window],
                     sequence.frame_names[last]);
}

}  // namespace

ClosestTable find_closest_windows(std::span<const DescribedFrames> sequences,
                                  const MatchSettings& settings, const Monitor& monitor) {
  ClosestTable table(sequences.size());
  for (size_t own = 0; own + 1 < sequences.size(); ++own)
    compare_with_later(sequences, own, settings,
                       part_of(monitor, "training", own, sequences.size() - 1), table);
  return table;
}

ThresholdTable compute_thresholds(std::span<const DescribedFrames> sequences, size_t window_length,
                                  double safety_factor, const Monitor& monitor) {
  const MatchSettings match{window_length, kDefaultMemoryLimit};
  return {window_length, safety_factor, find_closest_windows(sequences, match, monitor)};
}

bool is_left_to_queries(std::span<const DescribedFrames> sequences) {
  constexpr uint64_t kMostPairs = uint64_t{1} << 32;  // a few seconds
  uint64_t pairs = 0;
  uint64_t before = 0;
  for (const DescribedFrames& sequence : sequences) {
    pairs += before * sequence.rows.size();
    before += sequence.rows.size();
  }
  return pairs > kMostPairs;
}

double typical_distance(const TrainSequence& stored, const DescribedFrames& sequence,
                        const Monitor& monitor) {
  if (stored.typical_distance) return *stored.typical_distance;
  StatisticsSettings settings;
  settings.samples = 1000;
  return compute_statistics({&sequence, 1}, settings, monitor).typical_distance;
}

std::optional<double> automatic_threshold(const ThresholdTable& table, size_t sequence) {
  const auto& closest = table.closest[sequence];
  if (!closest) return std::nullopt;
  return static_cast<double>(closest->score) / static_cast<double>(table.window_length) *
         table.safety_factor;
}

void check_automatic(const SequenceDatabase& database, const SequenceQuerySettings& settings) {
  if (has_automatic_threshold(settings) && database.sequences.size() < 2)
    throw Error(ErrorKind::usage,
                "an automatic t_r needs two or more training sequences, and the database has one. "
                "For vpr-query --c-l, add --t-r 0.6, or --score zscore --decide margin");
}

bool is_same_place(double frame_distance, double mean_distance, size_t window_length) {
  constexpr double kDepth = 1.2;
  const double share = 1 - kDepth / std::sqrt(static_cast<double>(window_length));
  return frame_distance < share * mean_distance;
}

std::optional<std::string> overlap_warning(const ThresholdTable& table,
                                           std::span<const TrainSequence> sequences,
                                           std::span<const DescribedFrames> spans) {
  constexpr size_t kNamedPairs = 3;
  std::set<std::pair<size_t, size_t>> pairs;
  std::string text;
  for (size_t s = 0; s < table.closest.size(); ++s) {
    if (!table.closest[s]) continue;
    const ClosestWindows& closest = *table.closest[s];
    const size_t other = closest.other_sequence;
    const double distance =
        static_cast<double>(closest.score) / static_cast<double>(table.window_length);
    const FrameDistances between = frame_distances(spans.subspan(s, 1), spans[other]);
    const double mean = mean_distance_between(between);
    if (!is_same_place(distance, mean, table.window_length)) continue;
    if (!pairs.insert(std::minmax(s, other)).second || pairs.size() > kNamedPairs) continue;
    const Sequence& a = sequences[s].sequence;
    const Sequence& b = sequences[other].sequence;
    text += fmt::format(
        "{0}{1} and {2}{3}: {1} {4} and {2} {5} differ by {6:.1f} {8}, frames of the two by "
        "{7:.0f} on average",
        text.empty() ? "" : "; so do ", a.name, b.name,
        text.empty() ? " seem to show the same place, or places that look alike" : "",
        window_text(a, closest.window, table.window_length),
        window_text(b, closest.other_window, table.window_length), distance, mean,
        distance_of(spans[other].rows.shape.element).unit.name);
  }
  if (pairs.empty()) return std::nullopt;
  if (pairs.size() > kNamedPairs)
    text += fmt::format("; and so do {}", counted(pairs.size() - kNamedPairs, "other pair"));
  return text +
         ". If it is one place, their automatic t_r is too small. Train only one of them, or use "
         "--method filter";
}

}  // namespace vpr
