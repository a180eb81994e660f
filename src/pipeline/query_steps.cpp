#include "pipeline/query_steps.h"

#include <algorithm>

#include "pipeline/train.h"

namespace vpr {
namespace {

constexpr size_t kMostHits = 4'000'000'000;  // clusters are numbered by 32 bits
constexpr size_t kBytesPerHit = 64;  // while hits are collected, sorted, clustered and written

}  // namespace

TrainCodes searched_codes(const SequenceDatabase& database, const SequenceResult& result) {
  std::vector<CodeSpan> spans = code_spans(database);
  for (size_t s = 0; s < spans.size(); ++s)
    if (!result.sequences[s].searched) spans[s] = {};
  return make_train_codes(spans);
}

bool needs_maxima(const SequenceResult& result) {
  return result.settings.distance_threshold &&
         scale_of(result.settings) == ThresholdScale::relative;
}

void set_relative_limits(SequenceResult& result, const std::vector<uint32_t>& maxima) {
  for (size_t s = 0; s < result.sequences.size(); ++s) {
    SequenceThreshold& sequence = result.sequences[s];
    if (!sequence.searched || sequence.windows == 0) continue;
    sequence.max_distance = maxima[s];
    sequence.distance_limit = distance_limit(*sequence.threshold, maxima[s]);
  }
}

HitScanSettings scan_settings(const SequenceResult& result, const QueryResources& resources) {
  HitScanSettings settings;
  for (const SequenceThreshold& sequence : result.sequences)
    settings.limits.push_back(sequence.distance_limit);
  settings.query_windows = result.query_windows;
  settings.max_hits = std::min(resources.memory_limit / kBytesPerHit, kMostHits);
  settings.kernels = resources.kernels;
  return settings;
}

}  // namespace vpr
