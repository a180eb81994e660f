#include "recognition/same_place.h"

#include <cmath>
#include <set>

#include <fmt/format.h>

#include "matching/bit_counts.h"

namespace vpr {
namespace {

std::string window_text(const TrainSequence& sequence, size_t window, size_t length) {
  const size_t last = window + length - 1;
  return fmt::format("frames {} to {} ({} to {})", window, last, sequence.frame_names[window],
                     sequence.frame_names[last]);
}

std::string pair_sentence(const ThresholdTable& table, std::span<const TrainSequence> sequences,
                          size_t own, double bits, double mean) {
  const ClosestWindows& closest = *table.closest[own];
  const TrainSequence& a = sequences[own];
  const TrainSequence& b = sequences[closest.other_sequence];
  const std::string mine = window_text(a, closest.window, table.window_length);
  const std::string other = window_text(b, closest.other_window, table.window_length);
  if (own == closest.other_sequence)
    return fmt::format(
        "{} seems to show a place twice, or places that look alike: {} and {} differ by {:.1f} "
        "bits, its frames by {:.0f} on average. If it is one place, the automatic t_r is too "
        "small: "
        "train one of the visits only, as in --train {}@FIRST:LAST, or give a number as t_r",
        a.name, mine, other, bits, mean, a.name);
  return fmt::format(
      "{} and {} seem to show the same place, or places that look alike: {} {} and {} {} differ by "
      "{:.1f} bits, frames of the two by {:.0f} on average. If it is one place, their automatic "
      "t_r "
      "is too small: train only one of them, or give a number as t_r",
      a.name, b.name, a.name, mine, b.name, other, bits, mean);
}

}  // namespace

bool is_same_place(double bits_a_frame, double mean_distance, size_t window_length, double depth) {
  return bits_a_frame < (1 - depth / std::sqrt(static_cast<double>(window_length))) * mean_distance;
}

std::vector<std::string> overlap_warnings(const ThresholdTable& table,
                                          std::span<const TrainSequence> sequences,
                                          std::span<const CodeSpan> spans) {
  std::vector<BitCounts> counts;
  for (const CodeSpan& span : spans) counts.push_back(count_bits({&span, 1}));
  std::vector<std::string> warnings;
  std::set<std::pair<size_t, size_t>> named;
  for (size_t s = 0; s < table.closest.size(); ++s) {
    if (!table.closest[s]) continue;
    const size_t other = table.closest[s]->other_sequence;
    const double bits =
        static_cast<double>(table.closest[s]->distance) / static_cast<double>(table.window_length);
    const double mean = s == other ? mean_distance_within(counts[s])
                                   : mean_distance_between(counts[s], counts[other]);
    if (!is_same_place(bits, mean, table.window_length, s == other ? kOwnDepth : kPairDepth))
      continue;
    if (!named.insert(std::minmax(s, other)).second) continue;
    warnings.push_back(pair_sentence(table, sequences, s, bits, mean));
  }
  return warnings;
}

}  // namespace vpr
