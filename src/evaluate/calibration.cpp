#include "evaluate/calibration.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <map>

namespace vpr {
namespace {

constexpr size_t kMostFolds = 200;  // more cost time, and say the same

/// Windows [first, end) of a walk are not looked at.
struct Gap {
  size_t first = 0;
  size_t end = 0;

  bool holds(size_t window) const { return first <= window && window < end; }
};

/// Windows that are recognized at some strength.
struct Recognized {
  int64_t right = 0;
  int64_t wrong = 0;
};

bool is_wrong(const CalibrationWindow& window, int64_t strength) {
  return window.wrong && *window.wrong >= strength;
}

bool is_right(const CalibrationWindow& window, int64_t strength) {
  return !is_wrong(window, strength) && window.right && *window.right >= strength;
}

// Just above whatever is wrong.
int64_t above_all(std::span<const CalibrationWindow> windows, const Gap& gap, int64_t least) {
  int64_t strength = least;
  for (size_t w = 0; w < windows.size(); ++w) {
    if (gap.holds(w)) continue;
    for (const auto& reached : {windows[w].wrong, windows[w].untrained})
      if (reached && *reached >= strength) strength = *reached + 1;
  }
  return strength;
}

// From the strictest on: how many windows become right and wrong at which strength.
using Changes = std::map<int64_t, Recognized, std::greater<>>;

Changes changes_of(std::span<const CalibrationWindow> windows, const Gap& gap) {
  Changes changes;
  for (size_t w = 0; w < windows.size(); ++w) {
    if (gap.holds(w)) continue;
    const CalibrationWindow& window = windows[w];
    const bool comes_right = window.right && (!window.wrong || *window.right > *window.wrong);
    if (comes_right) ++changes[*window.right].right;
    if (!window.wrong) continue;
    ++changes[*window.wrong].wrong;
    if (comes_right) --changes[*window.wrong].right;
  }
  return changes;
}

std::optional<int64_t> reaching(std::span<const CalibrationWindow> windows, const Gap& gap,
                                double precision, int64_t least) {
  std::optional<int64_t> chosen;
  Recognized sum;
  for (const auto& [strength, change] : changes_of(windows, gap)) {
    if (strength < least) break;
    sum.right += change.right;
    sum.wrong += change.wrong;
    if (sum.right > 0 &&
        static_cast<double>(sum.right) >= precision * static_cast<double>(sum.right + sum.wrong))
      chosen = strength;
  }
  return chosen;
}

std::optional<int64_t> choose(std::span<const CalibrationWindow> windows, const Gap& gap,
                              const CalibrationSettings& settings) {
  if (settings.precision == 1) return above_all(windows, gap, settings.least);
  return reaching(windows, gap, settings.precision, settings.least);
}

// Which windows are wrong by the threshold that all but their fold, and a block around it, lead to.
std::vector<uint8_t> wrong_elsewhere(std::span<const CalibrationWindow> windows,
                                     const CalibrationSettings& settings) {
  std::vector<uint8_t> wrong(windows.size(), 0);
  const size_t size = std::max(settings.block, (windows.size() + kMostFolds - 1) / kMostFolds);
  for (size_t first = 0; first < windows.size(); first += size) {
    const Gap fold = {first, std::min(first + size, windows.size())};
    const Gap near = {first - std::min(first, settings.block), fold.end + settings.block};
    const std::optional<int64_t> strength = choose(windows, near, settings);
    for (size_t w = fold.first; strength && w < fold.end; ++w)
      wrong[w] = is_wrong(windows[w], *strength) ? 1 : 0;
  }
  return wrong;
}

FalseRecognitions expect(std::span<const CalibrationWindow> windows,
                         const CalibrationSettings& settings) {
  const std::vector<uint8_t> wrong = wrong_elsewhere(windows, settings);
  std::vector<double> begins(wrong.size(), 0);
  FalseRecognitions expected;
  for (size_t w = 0; w < wrong.size(); ++w) {
    if (wrong[w] == 0 || (w > 0 && wrong[w - 1] != 0)) continue;
    begins[w] = 1;
    ++expected.seen;
  }
  const Interval drawn = bootstrap_sum(begins, settings.block, settings.seed);
  const Interval counted = poisson_interval(expected.seen);
  expected.interval = {std::min(drawn.low, counted.low), std::max(drawn.high, counted.high)};
  return expected;
}

CalibrationAdvice missing_advice(std::span<const CalibrationWindow> windows,
                                 const CalibrationSettings& settings) {
  const bool any = std::any_of(windows.begin(), windows.end(), [&](const CalibrationWindow& w) {
    return w.right && *w.right >= settings.least;
  });
  return any ? CalibrationAdvice::none_is_safe : CalibrationAdvice::no_right_recognition;
}

}  // namespace

Calibration calibrate(std::span<const CalibrationWindow> windows,
                      const CalibrationSettings& settings) {
  assert(settings.precision > 0 && settings.precision <= 1 && settings.block > 0);
  Calibration found;
  const std::optional<int64_t> strength = choose(windows, {}, settings);
  for (const CalibrationWindow& window : windows) {
    if (!strength) break;
    found.right += is_right(window, *strength) ? 1 : 0;
    found.wrong += is_wrong(window, *strength) ? 1 : 0;
  }
  if (found.right == 0) {
    found.advice = missing_advice(windows, settings);
    return found;
  }
  found.advice = CalibrationAdvice::calibrated;
  found.strength = strength;
  found.expected = expect(windows, settings);
  return found;
}

}  // namespace vpr
