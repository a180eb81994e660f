#include "recognition/running_share.h"

#include <limits>

#include "base/running_quantile.h"

namespace vpr {

void limit_by_share(Result& result, double share) {
  RunningQuantile elsewhere(share);
  std::vector<double> limits;
  for (size_t window = 0; window < result.best.size(); ++window) {
    const auto& best = result.best[window];
    if (best && result.margins[window]) elsewhere.add(best->score + *result.margins[window]);
    limits.push_back(elsewhere.is_empty() ? std::numeric_limits<double>::infinity()
                                          : elsewhere.value());
  }
  std::erase_if(result.hits, [&](const Match& hit) { return hit.score >= limits[hit.query]; });
}

}  // namespace vpr
