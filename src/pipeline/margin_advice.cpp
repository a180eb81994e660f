#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <fmt/format.h>

#include "pipeline/advice.h"

namespace vpr {
namespace {

constexpr size_t kSuggestedShare = 10;

/// A query window and its margin a frame.
struct WindowMargin {
  size_t window = 0;
  double margin = 0;
};

// The largest first; ties to the first window.
std::vector<WindowMargin> largest_margins(const Result& result) {
  std::vector<WindowMargin> found;
  for (size_t window = 0; window < result.margins.size(); ++window)
    if (const auto margin = frame_margin(result, window)) found.push_back({window, *margin});
  std::stable_sort(found.begin(), found.end(), [](const WindowMargin& a, const WindowMargin& b) {
    return a.margin > b.margin;
  });
  return found;
}

std::optional<SuggestedThreshold> suggest(const Result& result,
                                          const std::vector<WindowMargin>& margins) {
  const double steps = std::pow(10, result.score().frame_digits);
  SuggestedThreshold suggested;
  suggested.scale.reset();
  const double reached = margins[(margins.size() - 1) / kSuggestedShare].margin;
  suggested.threshold = std::floor(reached * steps) / steps;
  if (suggested.threshold <= 0) return std::nullopt;
  suggested.windows = static_cast<size_t>(std::count_if(
      margins.begin(), margins.end(),
      [&](const WindowMargin& window) { return window.margin >= suggested.threshold; }));
  return suggested;
}

}  // namespace

std::optional<ThresholdAdvice> margin_advice(const Result& result) {
  if (!result.hits.empty() || result.best.empty()) return std::nullopt;
  const std::vector<WindowMargin> margins = largest_margins(result);
  ThresholdAdvice advice;
  if (result.path) {
    const auto& settings = std::get<SequenceQuerySettings>(result.settings);
    advice.sentence = fmt::format(
        "No path through training frames was followed for {} views with a margin of {:g} at its "
        "best, or for {} with {:g}, nor was there evidence of {:g} deviations for one "
        "(establish_views, establish_margin, establish_evidence of \"filter\"). Both "
        "walks must go the same way: the way back is another training sequence.",
        settings.filter.establish_views, settings.filter.establish_margin,
        2 * settings.filter.establish_views, settings.filter.establish_margin / 2,
        settings.filter.establish_evidence);
    return advice;
  }
  if (margins.empty()) {
    advice.sentence =
        "No best match has a margin, for no training window is elsewhere: the training sequences "
        "are not longer than +-w around it (--margin-width). Train longer ones, or take --decide "
        "threshold.";
    return advice;
  }
  const WindowMargin& largest = margins.front();
  const Match& best = *result.best[largest.window];
  const Target& target = result.targets[best.target];
  const size_t length = result.window_length();
  const int digits = result.score().frame_digits;
  advice.sentence = fmt::format(
      "No best match is enough better than the best one elsewhere. The largest margin is that of "
      "query frame {} at {} frame {}: {:.{}f} {}, where {:.{}f} is asked for.",
      anchor_of(largest.window, length), target.name, anchor_of(best.train, length), largest.margin,
      digits, result.score().margin_unit, target.margin.value_or(0), digits);
  advice.suggested = suggest(result, margins);
  return advice;
}

}  // namespace vpr
