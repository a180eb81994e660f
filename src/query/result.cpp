#include "query/result.h"

namespace vpr {

std::optional<double> frame_margin(const Result& result, size_t query_window) {
  if (query_window >= result.margins.size() || !result.margins[query_window]) return std::nullopt;
  return result.score().frame_value(*result.margins[query_window], result.window_length());
}

void cluster(Result& result, const Monitor& monitor) {
  const auto& settings = std::get<SequenceQuerySettings>(result.settings);
  result.clusters = result.path
                        ? cluster_paths(result.recognitions, result.path->numbers)
                        : cluster_recognitions(result.recognitions, settings.clustering, monitor);
}

size_t recognized_windows(const Result& result) {
  size_t windows = 0;
  for (size_t r = 0; r < result.recognitions.size(); ++r)
    if (r == 0 || result.recognitions[r].query != result.recognitions[r - 1].query) ++windows;
  return windows;
}

}  // namespace vpr
