// FAB-MAP's query time by places, words and words per frame, for every variant.
#pragma once

#include "bench/bench_result.h"

namespace vpr {

/// Settings of vpr-bench fabmap, which times every variant with every combination of the values.
struct FabmapBenchSettings {
  std::vector<std::string> variants = {"fabmap2", "fabmap2-fixed", "fbo", "lut", "fabmap1"};
  std::vector<uint64_t> places = {10, 100, 1000, 10'000, 100'000};
  std::vector<uint64_t> words = {10'000};
  std::vector<uint64_t> words_per_frame = {200};
  uint64_t pretrain_frames = 1000;
  uint64_t descriptors = 20'000;      ///< of 64 values, for k-means; 0: not timed
  uint64_t iterations = 20;           ///< of k-means
  double seconds = 0.3;               ///< per measurement
  double slow_limit = 1'000'000'000;  ///< places x words above which slow variants are omitted
};

template <class Visitor>
void visit_fields(FabmapBenchSettings& settings, Visitor&& visit) {
  visit("variants", settings.variants);
  visit("places", settings.places);
  visit("words", settings.words);
  visit("words_per_frame", settings.words_per_frame);
  visit("pretrain_frames", settings.pretrain_frames);
  visit("descriptors", settings.descriptors);
  visit("iterations", settings.iterations);
  visit("seconds", settings.seconds);
  visit("slow_limit", settings.slow_limit);
}

/// Words are drawn uniformly. Before a variant is timed, its results are compared with the
/// reference implementation on a hundred places. Also times the normalization of the posterior and
/// the training of the Chow-Liu tree.
BenchResult bench_fabmap(const FabmapBenchSettings& settings, uint64_t seed,
                         const Monitor& monitor);

}  // namespace vpr
