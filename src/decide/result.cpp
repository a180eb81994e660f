#include "decide/result.h"

#include <limits>

#include "match/rates.h"

namespace vpr {

ResultPath::ResultPath(size_t frames)
    : nowhere(frames, std::numeric_limits<double>::quiet_NaN()),
      rates(nowhere),
      tracks(frames, 0) {}

std::optional<double> frame_margin(const Result& result, size_t query_window) {
  if (query_window >= result.margins.size() || !result.margins[query_window]) return std::nullopt;
  return result.score().frame_value(*result.margins[query_window], result.window_length());
}

void cluster(Result& result, const Monitor& monitor) {
  const auto& settings = std::get<SequenceQuerySettings>(result.settings);
  result.clusters = result.path ? cluster_tracks(result.recognitions, result.path->tracks)
                                : cluster_by_target(result.recognitions, result.targets.size(),
                                                    settings.clustering, monitor);
}

size_t recognized_windows(const Result& result) {
  size_t windows = 0;
  for (size_t h = 0; h < result.recognitions.size(); ++h)
    if (h == 0 || result.recognitions[h].query != result.recognitions[h - 1].query) ++windows;
  return windows;
}

}  // namespace vpr
