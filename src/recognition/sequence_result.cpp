#include "recognition/sequence_result.h"

#include "base/json.h"

namespace vpr {

ThresholdScale scale_of(const SequenceQuerySettings& settings) {
  return settings.threshold_scale.value_or(settings.score == Score::raw ? ThresholdScale::relative
                                                                        : ThresholdScale::mean_z);
}

Json settings_in_force(const SequenceQuerySettings& settings) {
  SequenceQuerySettings in_force = settings;
  in_force.threshold_scale = scale_of(settings);
  Json json = value_to_json(in_force);
  if (settings.score == Score::raw)
    for (const char* key : {"score", "safety_margin", "standardization"}) json.erase(key);
  return json;
}

void cluster(SequenceResult& result, const Monitor& monitor) {
  Clusters found = cluster_by_sequence(result.hits, result.sequences.size(),
                                       result.settings.clustering, monitor);
  result.places = std::move(found.places);
  result.place_of = std::move(found.place_of);
}

}  // namespace vpr
