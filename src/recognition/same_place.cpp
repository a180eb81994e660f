#include "recognition/same_place.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "base/text.h"

namespace vpr {
namespace {

constexpr size_t kNamedPairs = 3;

std::string window_text(const TrainSequence& sequence, size_t window, size_t length) {
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
  const TrainSequence& a = sequences[overlap.own];
  const TrainSequence& b = sequences[closest.other_sequence];
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
