#include "recognition/joined_scans.h"

#include <algorithm>
#include <utility>

namespace vpr {

std::vector<uint32_t> joined_maxima(const Share& share, const std::vector<uint32_t>& own) {
  if (share.is_alone()) return own;
  const std::vector<uint32_t> all = collected(share, "maxima", own);
  std::vector<uint32_t> largest(own.size(), 0);
  for (size_t i = 0; i < all.size(); ++i)
    largest[i % own.size()] = std::max(largest[i % own.size()], all[i]);
  return spread(share, "maxima", std::move(largest));
}

HitScanResult joined_hits(const Share& share, HitScanResult own, size_t max_hits) {
  if (share.is_alone()) return own;
  uint64_t hits = own.hits.size();
  add_up(share, "hits", {&hits, 1});
  if (hits > max_hits) refuse_hits(max_hits);
  HitScanResult all;
  all.hits = collected(share, "hits", own.hits);
  std::sort(all.hits.begin(), all.hits.end(), by_position);
  std::vector<Cell> best(own.best.size(), Cell{0, 0, 0, kNoCell, 0});
  for (size_t window = 0; window < best.size(); ++window)
    if (own.best[window]) best[window] = *own.best[window];
  const std::vector<Cell> bests = collected(share, "best matches", best);
  all.best.resize(own.best.size());
  for (size_t i = 0; i < bests.size(); ++i) {
    auto& closest = all.best[i % best.size()];
    if (bests[i].score != kNoCell && (!closest || is_closer(bests[i], *closest)))
      closest = bests[i];
  }
  return all;
}

}  // namespace vpr
