#include "pipeline/fabmap_advice.h"

namespace vpr {
namespace {

// Frames that end c_w frames in a row whose likeliest view is the same and above t_p (strict).
size_t recognised_frames(const FabmapResult& result, double place_threshold) {
  size_t frames = 0;
  uint64_t run = 0;
  std::optional<uint32_t> view;
  for (const std::optional<PlaceMatch>& match : result.best) {
    const bool is_above = match && match->probability > place_threshold;
    run = !is_above ? 0 : view == match->view ? run + 1 : 1;
    view = is_above ? std::optional(match->view) : std::nullopt;
    if (run >= result.settings.window) ++frames;
  }
  return frames;
}

}  // namespace

std::optional<LowerThreshold> lower_place_threshold(const FabmapResult& result) {
  std::optional<LowerThreshold> advice;
  for (const std::optional<PlaceMatch>& match : result.best)
    if (match && (!advice || match->probability > advice->best.probability))
      advice = LowerThreshold{*match, std::nullopt, 0};
  if (!advice) return advice;
  for (const int unit : {10, 100}) {
    for (int step = 9; step >= 1; --step) {
      const double threshold = static_cast<double>(step) / unit;
      if (threshold >= result.settings.place_threshold) continue;
      advice->frames = recognised_frames(result, threshold);
      if (advice->frames == 0) continue;
      advice->place_threshold = threshold;
      return advice;
    }
  }
  return advice;
}

}  // namespace vpr
