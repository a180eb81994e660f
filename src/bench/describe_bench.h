// Time per frame for decoding, resizing, LDB and each local feature.
#pragma once

#include "bench/bench_result.h"
#include "fabmap/local_features.h"
#include "sequence/sequence_source.h"

namespace vpr {

/// Settings of vpr-bench describe.
struct DescribeBenchSettings {
  std::vector<std::string> features = {"surf", "sift", "kaze", "akaze", "orb", "brisk"};
  uint64_t frames = 20;  ///< number of different frames, used in turn
  double seconds = 1;    ///< per measurement
  FeatureSettings feature_settings;
};

template <class Visitor>
void visit_fields(DescribeBenchSettings& settings, Visitor&& visit) {
  visit("feature_kinds", settings.features);
  visit("frames", settings.frames);
  visit("seconds", settings.seconds);
  visit("feature_settings", settings.feature_settings);
}

/// `images`: a folder or list of images; without it, generated 640x480 JPEG files in memory.
BenchResult bench_describe(const DescribeBenchSettings& settings,
                           const std::optional<SequenceSource>& images, uint64_t seed,
                           const Monitor& monitor);

}  // namespace vpr
