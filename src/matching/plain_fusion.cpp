// The oracle of fused scores.
#include <algorithm>
#include <cmath>
#include <limits>

#include "matching/fusion.h"
#include "matching/view_evidence.h"

namespace vpr {
namespace {

/// Where a matched training frame is.
struct Place {
  size_t sequence = 0;
  size_t frame = 0;
  size_t neighbours = 0;
};

std::vector<Place> places_of(const FusionBasis& basis) {
  std::vector<Place> places;
  for (const FusedWalk& walk : basis.walks)
    for (size_t i = 0; i < walk.frames; ++i) places.push_back({walk.sequence, i, walk.neighbours});
  return places;
}

bool is_elsewhere(const FusedViews& views, const Place& a, const Place& b) {
  if (a.sequence == b.sequence)
    return std::max(a.frame, b.frame) - std::min(a.frame, b.frame) > a.neighbours;
  const std::pair pair(std::min(a.sequence, b.sequence), std::max(a.sequence, b.sequence));
  return std::find(views.shared_places.begin(), views.shared_places.end(), pair) ==
         views.shared_places.end();
}

}  // namespace

double fusion_tolerance(const FusionBasis& basis) {
  // Likelihoods are off by 0.6, their mean and the largest elsewhere by as much or half a unit
  // more, and what is taken is rounded.
  return basis.evidence == nullptr ? 0 : 0.5 + 2 * basis.weight;
}

std::vector<double> plain_fusion_row(const FusionBasis& basis, const WordSet& words) {
  std::vector<double> row(basis.views.size(), 0);
  if (words.empty()) return row;
  const ViewEvidence& evidence = *basis.evidence;
  const ViewWords& views = evidence.of->fabmap.views;
  const std::vector<double> nats =
      fabmap1_log_likelihoods({evidence.model, views, evidence.index, words, views.views()});
  const std::vector<Place> places = places_of(basis);
  const auto is_known = [&](size_t i) { return basis.views[i] != FusedViews::kNoView; };
  double sum = 0;
  double count = 0;
  for (size_t i = 0; i < row.size(); ++i) {
    if (!is_known(i)) continue;
    sum += nats[basis.views[i]];
    ++count;
  }
  for (size_t i = 0; i < row.size(); ++i) {
    if (!is_known(i)) continue;
    double elsewhere = -std::numeric_limits<double>::infinity();
    for (size_t k = 0; k < row.size(); ++k)
      if (is_known(k) && is_elsewhere(*evidence.of, places[i], places[k]))
        elsewhere = std::max(elsewhere, nats[basis.views[k]]);
    const double likelihood = nats[basis.views[i]];
    const double level = std::clamp(likelihood - sum / count, -4.0, 6.0);
    const double lead =
        std::isinf(elsewhere) ? 0 : std::clamp(likelihood - elsewhere - 2, 0.0, 10.0);
    row[i] = basis.weight * (level / 2 + lead);
  }
  return row;
}

}  // namespace vpr
