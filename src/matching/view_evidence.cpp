#include "matching/view_evidence.h"

#include <algorithm>
#include <cmath>

namespace vpr {
namespace {

constexpr double kMostNats = 1e6;  // that fit

int32_t in_units(double nats) {
  return static_cast<int32_t>(std::floor(std::clamp(nats, -kMostNats, kMostNats) * kNatUnit + 0.5));
}

}  // namespace

std::shared_ptr<const ViewEvidence> make_view_evidence(std::shared_ptr<const FusedViews> views) {
  const FabmapDatabase& database = views->fabmap;
  FabmapModel model = make_fabmap_model(database.tree, {}, WordModel::tree);
  FabmapIndex index = make_fabmap_index(model, database.views, database.index);
  return std::make_shared<const ViewEvidence>(
      ViewEvidence{std::move(views), std::move(model), std::move(index)});
}

std::vector<int32_t> view_likelihoods(const ViewEvidence& evidence, const WordSet& words) {
  const ViewWords& views = evidence.of->fabmap.views;
  const std::vector<double> nats =
      fabmap2_fixed_log_likelihoods({evidence.model, views, evidence.index, words, views.views()});
  std::vector<int32_t> likelihoods(nats.size());
  // The first view's is a number like any other: what is added to all is taken away with it.
  std::transform(nats.begin(), nats.end(), likelihoods.begin(),
                 [&](double value) { return in_units(value - nats.front()); });
  return likelihoods;
}

}  // namespace vpr
