#include "tune/calibration.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <map>

namespace vpr {
namespace {

constexpr size_t kMaxFolds = 200;  // limits the time

/// Windows [first, end) are excluded.
struct Gap {
  size_t first = 0;
  size_t end = 0;

  bool holds(size_t window) const { return first <= window && window < end; }
};

struct WindowCounts {
  int64_t correct = 0;
  int64_t incorrect = 0;
};

bool reaches(const std::optional<int64_t>& margin, int64_t strength) {
  return margin && *margin >= strength;
}

std::optional<int64_t> choose(std::span<const CalibrationWindow> windows, const Gap& gap,
                              const CalibrationSettings& settings) {
  int64_t above_all = settings.least;
  std::map<int64_t, WindowCounts, std::greater<>> changes;  // from the largest strength on
  for (size_t w = 0; w < windows.size(); ++w) {
    if (gap.holds(w)) continue;
    const CalibrationWindow& window = windows[w];
    for (const auto& strength : {window.incorrect, window.unknown_place})
      if (strength) above_all = std::max(above_all, *strength + 1);
    if (settings.precision == 1) continue;
    if (window.correct) ++changes[*window.correct].correct;
    if (window.incorrect) ++changes[*window.incorrect].incorrect;
  }
  if (settings.precision == 1) return above_all;
  std::optional<int64_t> chosen;
  WindowCounts sum;
  for (const auto& [strength, change] : changes) {
    if (strength < settings.least) break;
    sum.correct += change.correct;
    sum.incorrect += change.incorrect;
    if (sum.correct > 0 &&
        static_cast<double>(sum.correct) >=
            settings.precision * static_cast<double>(sum.correct + sum.incorrect))
      chosen = strength;
  }
  return chosen;
}

// Cross-validation: the strength for each fold is chosen without the fold and a block around it.
FalseRecognitions expect(std::span<const CalibrationWindow> windows,
                         const CalibrationSettings& settings) {
  std::vector<double> begins(windows.size(), 0);  // 1 where a run of incorrect windows begins
  FalseRecognitions expected;
  bool was_wrong = false;
  const size_t size = std::max(settings.block, (windows.size() + kMaxFolds - 1) / kMaxFolds);
  for (size_t first = 0; first < windows.size(); first += size) {
    const size_t end = std::min(first + size, windows.size());
    const Gap gap = {first - std::min(first, settings.block), end + settings.block};
    const std::optional<int64_t> strength = choose(windows, gap, settings);
    for (size_t w = first; w < end; ++w) {
      const bool is_wrong_now = strength && reaches(windows[w].incorrect, *strength);
      if (is_wrong_now && !was_wrong) {
        begins[w] = 1;
        ++expected.seen;
      }
      was_wrong = is_wrong_now;
    }
  }
  const Interval drawn = bootstrap_sum(begins, settings.block, settings.seed);
  const Interval counted = poisson_interval(expected.seen);
  expected.interval = {std::min(drawn.low, counted.low), std::max(drawn.high, counted.high)};
  return expected;
}

}  // namespace

UnknownPlaceScan::UnknownPlaceScan(const GroundTruth& truth, ExclusionZones elsewhere,
                                   size_t window_length, size_t query_windows,
                                   const RowKernels& kernels)
    : truth_(truth),
      widths_(elsewhere.widths),
      window_length_(window_length),
      untrained_(std::move(elsewhere), query_windows, kernels) {}

void UnknownPlaceScan::operator()(std::span<const ScoreRow> row) {
  const size_t anchor = window_length_ - 1;
  std::vector<ScoreRow> unknown_place;
  for (const ScoreRow& piece : row) {
    const size_t width = widths_[piece.sequence];
    const size_t first = piece.train_window + anchor;  // frames of the piece: [first, end)
    const size_t end = first + piece.scores.size();
    size_t next = first;
    for (const LabelStretch& run :
         label_runs(truth_, piece.query_window + anchor, piece.sequence, end + width)) {
      const size_t begin = run.first - std::min(run.first, width);
      if (begin > next) unknown_place.push_back(part_of_row(piece, next - first, begin - next));
      next = std::max(next, run.last + width + 1);
    }
    if (next < end) unknown_place.push_back(part_of_row(piece, next - first, end - next));
  }
  if (!unknown_place.empty()) untrained_(unknown_place);
}

Calibration calibrate(std::span<const CalibrationWindow> windows,
                      const CalibrationSettings& settings) {
  assert(settings.precision > 0 && settings.precision <= 1 && settings.block > 0);
  Calibration found;
  if (const std::optional<int64_t> strength = choose(windows, {}, settings)) {
    for (const CalibrationWindow& window : windows) {
      found.correct += reaches(window.correct, *strength) ? 1 : 0;
      found.incorrect += reaches(window.incorrect, *strength) ? 1 : 0;
    }
    found.strength = strength;
  }
  if (found.correct > 0) {
    found.advice = CalibrationAdvice::calibrated;
    found.expected = expect(windows, settings);
    return found;
  }
  found.strength.reset();
  if (std::ranges::any_of(windows, [&](const CalibrationWindow& window) {
        return reaches(window.correct, settings.least);
      }))
    found.advice = CalibrationAdvice::none_is_safe;
  return found;
}

}  // namespace vpr
