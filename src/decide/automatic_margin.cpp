#include "decide/automatic_margin.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "base/monitor.h"
#include "base/text.h"
#include "decide/elsewhere.h"
#include "match/match.h"
#include "match/zscores.h"

namespace vpr {

namespace {

size_t windows_of(size_t frames, size_t window_length) {
  return frames < window_length ? 0 : frames - window_length + 1;
}

FrameDistances scored(FrameDistances distances, const std::optional<ScoreBasis>& basis,
                      const Monitor& monitor) {
  return basis ? zscores(std::move(distances), *basis, monitor) : distances;
}

std::optional<ScoreBasis> basis_of_kept(const ScoreBasis* basis,
                                        std::span<const DescriptorSpan> sequences,
                                        const std::vector<uint8_t>& keep) {
  return basis == nullptr ? std::nullopt : std::optional(basis_of(*basis, sequences, keep));
}

// A mean frame distance of windows of one walk.
double distance_a_frame(const DescriptorSpan& walk, size_t a, size_t b, size_t window_length) {
  uint64_t sum = 0;
  for (size_t k = 0; k < window_length; ++k) sum += frame_distance(walk.rows, a + k, b + k);
  return static_cast<double>(sum) / static_cast<double>(window_length);
}

void add_own(std::vector<uint32_t>& margins, const DescriptorSpan& walk, uint32_t width,
             const std::optional<ScoreBasis>& basis, const MatchSettings& settings,
             const Monitor& monitor, size_t most_pairs) {
  const size_t length = settings.window_length;
  const size_t windows = windows_of(walk.rows.size(), length);
  if (windows == 0) return;
  MarginScan scan(make_elsewhere({width}, {}), windows, settings.kernels);
  const auto match = [&](const FrameDistances& distances, const WholeRowConsumer& consume) {
    vpr::match(scored(distances, basis, monitor), settings, {{}, {consume}}, monitor);
  };
  match_far(walk, length, half_width(walk, monitor) + length, match, std::ref(scan), most_pairs);
  const MarginScanResult& found = scan.result();
  const double mean = mean_distance_within(frame_distances({&walk, 1}, walk));
  for (size_t window = 0; window < windows; ++window) {
    if (!found.margins[window]) continue;
    const double distance =
        distance_a_frame(walk, window, found.best[window]->train_window, length);
    if (!is_same_place(distance, mean, length, kOwnDepth))
      margins.push_back(*found.margins[window]);
  }
}

void add_others(std::vector<uint32_t>& margins, std::span<const DescriptorSpan> sequences,
                size_t own, const Elsewhere& elsewhere, const ScoreBasis* basis,
                const MatchSettings& settings, const Monitor& monitor, size_t most_pairs) {
  std::vector<DescriptorSpan> others(sequences.begin(), sequences.end());
  std::vector<uint8_t> keep(sequences.size(), 1);
  for (size_t s = 0; s < sequences.size(); ++s)
    if (s == own || elsewhere.shared[own][s] != 0) {
      others[s] = {sequences[s].rows.first(0), {}};
      keep[s] = 0;
    }
  const DescriptorSpan& walk = sequences[own];
  const size_t frames = count_frames(others);
  if (frames == 0 || walk.rows.size() < settings.window_length) return;
  const FrameDistances distances = frame_distances(others, {walk.rows.first(0), {}});
  const std::optional<ScoreBasis> own_basis = basis_of_kept(basis, sequences, keep);
  for (const Stretch& stretch :
       choose_stretches(walk, frames, settings.window_length, most_pairs)) {
    MarginScan scan(elsewhere, windows_of(stretch.count, settings.window_length), settings.kernels);
    match(scored(distances.of_query(stretch.of(walk)), own_basis, monitor), settings,
          {{}, {std::ref(scan)}}, monitor);
    for (const auto& margin : scan.result().margins)
      if (margin) margins.push_back(*margin);
  }
}

// Of n exponential values with this mean, one in e^4 times has a larger one than mean (ln n + 4).
uint32_t largest_likely(std::span<const uint32_t> false_margins, uint64_t mean) {
  const double most =
      static_cast<double>(mean) * (std::log(static_cast<double>(false_margins.size())) + 4);
  const auto likely = std::find_if(false_margins.begin(), false_margins.end(),
                                   [&](uint32_t margin) { return margin <= most; });
  return likely == false_margins.end() ? 0 : *likely;
}

constexpr size_t kNamedPairs = 3;

std::string window_text(const Sequence& sequence, size_t window, size_t length) {
  const size_t last = window + length - 1;
  return fmt::format("frames {} to {} ({} to {})", window, last, sequence.frame_names[window],
                     sequence.frame_names[last]);
}

/// Two windows that are too close.
struct Overlap {
  size_t own = 0;
  double distance = 0;  ///< a frame
  double mean = 0;      ///< of frames of the two
  std::string_view unit;
};

std::string pair_text(const ThresholdTable& table, std::span<const TrainSequence> sequences,
                      const Overlap& overlap, std::string_view seem) {
  const ClosestWindows& closest = *table.closest[overlap.own];
  const Sequence& a = sequences[overlap.own].sequence;
  const Sequence& b = sequences[closest.other_sequence].sequence;
  return fmt::format(
      "{0} and {1}{2}: {0} {3} and {1} {4} differ by {5:.1f} {7}, frames of the "
      "two by {6:.0f} on average",
      a.name, b.name, seem, window_text(a, closest.window, table.window_length),
      window_text(b, closest.other_window, table.window_length), overlap.distance, overlap.mean,
      overlap.unit);
}

std::string pairs_sentence(const ThresholdTable& table, std::span<const TrainSequence> sequences,
                           const std::vector<Overlap>& overlaps) {
  const size_t named = std::min(overlaps.size(), kNamedPairs);
  std::string text = pair_text(table, sequences, overlaps[0],
                               " seem to show the same place, or places that look alike");
  for (size_t i = 1; i < named; ++i)
    text += "; so do " + pair_text(table, sequences, overlaps[i], "");
  if (overlaps.size() > named)
    text += fmt::format("; and so do {}", counted(overlaps.size() - named, "other pair"));
  return text +
         ". If it is one place, their automatic t_r is too small. Train only one of them, or use "
         "--method filter";
}

}  // namespace

std::vector<uint32_t> false_margins(std::span<const DescriptorSpan> sequences,
                                    const Elsewhere& elsewhere, const ScoreBasis* basis,
                                    const MatchSettings& settings, const Monitor& monitor,
                                    size_t most_pairs) {
  std::vector<uint32_t> margins;
  for (size_t s = 0; s < sequences.size(); ++s) {
    const Monitor part = part_of(monitor, "training", s, sequences.size());
    std::vector<uint8_t> keep(sequences.size(), 0);
    keep[s] = 1;
    add_own(margins, sequences[s], elsewhere.widths[s], basis_of_kept(basis, sequences, keep),
            settings, part, most_pairs);
    add_others(margins, sequences, s, elsewhere, basis, settings, part, most_pairs);
  }
  std::sort(margins.begin(), margins.end(), std::greater<>());
  return margins;
}

double automatic_margin(std::span<const uint32_t> false_margins, const ScoreKind& score,
                        double typical_distance, size_t window_length) {
  const double least = score.least_margin(typical_distance, window_length);
  if (false_margins.empty()) return least;
  const uint64_t sum = std::accumulate(false_margins.begin(), false_margins.end(), uint64_t{0});
  const uint64_t mean = sum / false_margins.size();
  const uint64_t above = largest_likely(false_margins, mean) + mean + 1;
  return std::max(least, score.frame_value(static_cast<double>(above), window_length));
}

bool is_same_place(double distance_a_frame, double mean_distance, size_t window_length,
                   double depth) {
  return distance_a_frame <
         (1 - depth / std::sqrt(static_cast<double>(window_length))) * mean_distance;
}

std::optional<std::string> overlap_warning(const ThresholdTable& table,
                                           std::span<const TrainSequence> sequences,
                                           std::span<const DescriptorSpan> spans) {
  std::vector<Overlap> overlaps;
  std::set<std::pair<size_t, size_t>> named;
  for (size_t s = 0; s < table.closest.size(); ++s) {
    if (!table.closest[s]) continue;
    const size_t other = table.closest[s]->other_sequence;
    const double distance =
        static_cast<double>(table.closest[s]->score) / static_cast<double>(table.window_length);
    const FrameDistances between = frame_distances(spans.subspan(s, 1), spans[other]);
    const double mean = mean_distance_between(between);
    if (!is_same_place(distance, mean, table.window_length, kPairDepth)) continue;
    if (named.insert(std::minmax(s, other)).second)
      overlaps.push_back({s, distance, mean, between.unit.name});
  }
  if (overlaps.empty()) return std::nullopt;
  return pairs_sentence(table, sequences, overlaps);
}

}  // namespace vpr
