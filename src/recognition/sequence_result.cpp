#include "recognition/sequence_result.h"

#include <algorithm>

#include "base/json.h"

namespace vpr {

ThresholdScale scale_of(const SequenceQuerySettings& settings) {
  return settings.threshold_scale.value_or(score_kind(settings.score).number_scale);
}

Json settings_in_force(const SequenceQuerySettings& settings) {
  SequenceQuerySettings in_force = settings;
  in_force.threshold_scale = scale_of(settings);
  Json json = value_to_json(in_force);
  const auto own = score_kind(settings.score).settings;
  for (const std::string_view key : score_settings())
    if (std::find(own.begin(), own.end(), key) == own.end()) json.erase(key);
  return json;
}

void cluster(SequenceResult& result, const Monitor& monitor) {
  Clusters found = cluster_by_sequence(result.hits, result.sequences.size(),
                                       result.settings.clustering, monitor);
  result.places = std::move(found.places);
  result.place_of = std::move(found.place_of);
}

}  // namespace vpr
