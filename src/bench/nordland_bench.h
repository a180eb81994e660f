// The paper's Nordland tables: long databases, c_l 300.
#pragma once

#include "bench/matching_bench.h"

namespace vpr {

/// What vpr-bench nordland times.
struct NordlandBenchSettings {
  std::vector<std::string> methods = {
      "fastable-online", "fastable",       "standardized", "openable",
      "plain-fastable",  "plain-openable", "lsh"};
  std::vector<uint64_t> databases = {1000, 10'000, 100'000, 1'000'000};  ///< frames
  uint64_t window_length = 300;                                          ///< c_l
  uint64_t query_frames = 1000;
  double seconds = 1;                  ///< of each measurement
  uint64_t changed_bits = 150;         ///< of generated query frames
  uint64_t lsh_most_frames = 100'000;  ///< longer databases take minutes to hash
  uint64_t ring_bytes = 512ULL << 20;  ///< for FastABLE's ring; beyond, it works without
  std::vector<uint64_t> lsh_probe_levels = {0, 1, 2};  ///< instead of the one in lsh
  LshSettings lsh = {};
};

template <class Visitor>
void visit_fields(NordlandBenchSettings& settings, Visitor&& visit) {
  visit("methods", settings.methods);
  visit("databases", settings.databases);
  visit("c_l", settings.window_length);
  visit("query_frames", settings.query_frames);
  visit("seconds", settings.seconds);
  visit("changed_bits", settings.changed_bits);
  visit("lsh_most_frames", settings.lsh_most_frames);
  visit("ring_bytes", settings.ring_bytes);
  visit("lsh_probe_levels", settings.lsh_probe_levels);
  visit("lsh", settings.lsh);
}

/// Real codes to use instead of generated ones; databases longer than them are left out.
struct RecordedCodes {
  std::vector<LdbCode> train;
  std::vector<LdbCode> query;
};

/// Times methods as bench_matching does; a database that does not fit the memory is left out, and
/// said.
BenchResult bench_nordland(const NordlandBenchSettings& settings,
                           const std::optional<RecordedCodes>& recorded, uint64_t seed,
                           const RowKernels& kernels, const Monitor& monitor);

}  // namespace vpr
