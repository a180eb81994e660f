#include "pipeline/fabmap_advice.h"

namespace vpr {
namespace {

const FabmapQuerySettings& settings_of(const Result& result) {
  return std::get<FabmapQuerySettings>(result.settings);
}

// Frames that end c_w frames in a row whose likeliest view is the same and above t_p (strict).
size_t recognised_frames(const Result& result, double place_threshold) {
  size_t frames = 0;
  uint64_t run = 0;
  std::optional<uint32_t> view;
  for (const std::optional<Match>& match : result.best) {
    const bool is_above = match && match->score > place_threshold;
    run = !is_above ? 0 : view == match->view ? run + 1 : 1;
    view = is_above ? std::optional(match->view) : std::nullopt;
    if (run >= settings_of(result).window) ++frames;
  }
  return frames;
}

}  // namespace

std::optional<LowerThreshold> lower_place_threshold(const Result& result) {
  std::optional<LowerThreshold> advice;
  for (const std::optional<Match>& match : result.best)
    if (match && (!advice || match->score > advice->best.score))
      advice = LowerThreshold{*match, std::nullopt, 0};
  if (!advice) return advice;
  for (const int unit : {10, 100}) {
    for (int step = 9; step >= 1; --step) {
      const double threshold = static_cast<double>(step) / unit;
      if (threshold >= settings_of(result).place_threshold) continue;
      advice->frames = recognised_frames(result, threshold);
      if (advice->frames == 0) continue;
      advice->place_threshold = threshold;
      return advice;
    }
  }
  return advice;
}

}  // namespace vpr
