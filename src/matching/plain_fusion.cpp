// The oracle of fused scores.
#include <algorithm>
#include <cmath>
#include <limits>

#include "matching/fusion.h"
#include "matching/view_evidence.h"

namespace vpr {

double fusion_tolerance(const FusionBasis& basis) {
  // Likelihoods are off by 0.6, the largest by as much, and their mean by less; a score is rounded
  // again. Of the scale, by which scores of 64 deviations may be taken, 1.2 / 1024 nats change no
  // more than half of that times the weight, which is 1 at most.
  return basis.evidence == nullptr ? 0 : 0.5 + 2 + 64 * 1.2 / 2;
}

FusionRow plain_fusion_row(const FusionBasis& basis, const WordSet& words, double weight) {
  FusionRow row{std::vector<double>(basis.views.size(), 0), 1, std::nullopt};
  if (words.empty()) return row;
  const ViewEvidence& evidence = *basis.evidence;
  const ViewWords& views = evidence.of->fabmap.views;
  const std::vector<double> nats =
      fabmap1_log_likelihoods({evidence.model, views, evidence.index, words, views.views()});
  const auto is_known = [&](size_t i) { return basis.views[i] != FusedViews::kNoView; };
  for (size_t i = 0; i < row.added.size(); ++i)
    if (is_known(i) && (!row.likeliest || nats[basis.views[i]] > nats[basis.views[*row.likeliest]]))
      row.likeliest = i;
  if (!row.likeliest) return row;
  const double most = nats[basis.views[*row.likeliest]];
  const auto behind = [&](size_t i) { return std::max(nats[basis.views[i]] - most, -40.0); };
  double sum = 0;
  double count = 0;
  for (size_t i = 0; i < row.added.size(); ++i) {
    sum += is_known(i) ? behind(i) : 0;
    count += is_known(i) ? 1 : 0;
  }
  double squares = 0;
  for (size_t i = 0; i < row.added.size(); ++i) {
    if (is_known(i)) row.added[i] = -weight * (behind(i) - sum / count);
    squares += row.added[i] * row.added[i];
  }
  row.scale = 1 / std::sqrt(1 + squares / count);
  return row;
}

}  // namespace vpr
