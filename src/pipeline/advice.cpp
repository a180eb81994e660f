#include "pipeline/advice.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

namespace vpr {
namespace {

constexpr double kMostHits = 0.2;  // of all cells
constexpr size_t kSuggestedShare = 10;

// Numbers that a suggested threshold may be, apart from each other by 1 / this.
double steps_of(ThresholdScale scale) {
  switch (scale) {
    case ThresholdScale::relative:
    case ThresholdScale::mean:
      return 1000;
    case ThresholdScale::bits:
      return 10;
    case ThresholdScale::mean_z:
      break;
  }
  return 100;
}

double value_of(const SequenceResult& result, const Cell& cell) {
  const SequenceThreshold& sequence = result.sequences[cell.sequence];
  const uint64_t length = result.settings.window_length;
  if (sequence.scale == ThresholdScale::mean_z) return mean_z(cell.distance, length);
  const double divisor = sequence.scale == ThresholdScale::bits ? static_cast<double>(length)
                         : sequence.scale == ThresholdScale::mean
                             ? sequence.window_means[cell.query_window]
                             : sequence.max_distance.value_or(0);
  return divisor == 0 ? 0 : static_cast<double>(cell.distance) / divisor;
}

std::vector<Cell> best_matches(const SequenceResult& result) {
  std::vector<Cell> found;
  for (const auto& cell : result.best)
    if (cell) found.push_back(*cell);
  std::sort(found.begin(), found.end(), [&](const Cell& a, const Cell& b) {
    const double value_a = value_of(result, a);
    const double value_b = value_of(result, b);
    return value_a != value_b ? value_a < value_b : a.query_window < b.query_window;
  });
  return found;
}

double count_cells(const SequenceResult& result, size_t query_windows) {
  double train_windows = 0;
  for (const SequenceThreshold& sequence : result.sequences)
    if (sequence.searched) train_windows += static_cast<double>(sequence.windows);
  return train_windows * static_cast<double>(query_windows);
}

std::string closest_text(const SequenceResult& result, const Cell& cell) {
  const SequenceThreshold& sequence = result.sequences[cell.sequence];
  std::string text = fmt::format(
      "The closest are query frame {} and {} frame {}: ", result.anchor(cell.query_window),
      sequence.name, result.anchor(cell.train_window));
  if (sequence.scale == ThresholdScale::mean_z)
    return text + fmt::format("mean z {:.2f}", value_of(result, cell));
  if (sequence.scale == ThresholdScale::relative)
    text += fmt::format("{:.3f} of the largest distance, ", value_of(result, cell));
  if (sequence.scale == ThresholdScale::mean)
    text +=
        fmt::format("{:.3f} of what this window differs by on average, ", value_of(result, cell));
  return text +
         fmt::format("{:.1f} bits a frame", static_cast<double>(cell.distance) /
                                                static_cast<double>(result.settings.window_length));
}

std::optional<SuggestedThreshold> suggest(const SequenceResult& result,
                                          const std::vector<Cell>& best) {
  const SequenceThreshold& sequence = result.sequences[best.front().sequence];
  const double steps = steps_of(sequence.scale);
  const double reached = value_of(result, best[(best.size() - 1) / kSuggestedShare]);
  SuggestedThreshold suggested;
  suggested.scale = sequence.scale;
  suggested.threshold = (std::floor(reached * steps) + 1) / steps;
  if (suggested.scale == ThresholdScale::relative || suggested.scale == ThresholdScale::mean)
    suggested.threshold = std::min(suggested.threshold, 1.0);
  if (suggested.scale == ThresholdScale::mean_z)
    suggested.threshold = std::min(suggested.threshold, 0.0);
  for (const Cell& cell : best)
    if (value_of(result, cell) < suggested.threshold) ++suggested.windows;
  if (suggested.windows == 0) return std::nullopt;
  return suggested;
}

}  // namespace

size_t recognised_windows(const SequenceResult& result) {
  size_t windows = 0;
  for (size_t h = 0; h < result.hits.size(); ++h)
    if (h == 0 || result.hits[h].query_window != result.hits[h - 1].query_window) ++windows;
  return windows;
}

std::optional<ThresholdAdvice> threshold_advice(const SequenceResult& result) {
  const std::vector<Cell> best = best_matches(result);
  if (best.empty()) return std::nullopt;
  const double share = static_cast<double>(result.hits.size()) / count_cells(result, best.size());
  ThresholdAdvice advice;
  advice.is_too_large = share > kMostHits;
  if (!advice.is_too_large && !result.hits.empty()) return std::nullopt;
  advice.suggested = suggest(result, best);
  const auto& used = result.sequences[best.front().sequence].threshold;
  if (advice.is_too_large && advice.suggested && used && advice.suggested->threshold >= *used)
    advice.suggested.reset();
  advice.sentence =
      (advice.is_too_large
           ? fmt::format("{:.0f} % of all window pairs are hits: t_r is too large to tell places "
                         "apart. ",
                         100 * share)
           : std::string("Nothing is close enough. ")) +
      closest_text(result, best.front()) + ".";
  return advice;
}

}  // namespace vpr
