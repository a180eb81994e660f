// Matching time against database size, window length and query length: the paper's speed-up table
// (tab6) and figures, and its Nordland tables (tab5, tab7).
#pragma once

#include "bench/bench_result.h"
#include "matching/rows.h"

namespace vpr {

/// What vpr-bench matching times: every method with every combination of the numbers.
struct MatchingBenchSettings {
  std::vector<std::string> methods = {"fastable-online", "fastable",       "standardized",
                                      "openable",        "plain-fastable", "plain-openable"};
  std::vector<uint64_t> databases = {500, 1000, 2000, 4000, 8000};  ///< frames
  std::vector<uint64_t> window_lengths = {20, 40, 60, 80};          ///< c_l
  std::vector<uint64_t> query_frames = {1000};
  uint64_t clustered_hits = 1'000'000;  ///< 0: clustering is not timed
  double seconds = 0.3;                 ///< of each measurement
  uint64_t changed_bits = 150;          ///< by which query frames differ from training frames
  /// Of generated vectors, compared by 1 - cos; 0: LDB codes. Other methods than those that take
  /// any distances are left out.
  uint64_t descriptor_length = 0;
  uint64_t precision = 16;  ///< bits of a number of these: 16 or 8
  LshSettings lsh = {};
};

template <class Visitor>
void visit_fields(MatchingBenchSettings& settings, Visitor&& visit) {
  visit("methods", settings.methods);
  visit("databases", settings.databases);
  visit("c_l", settings.window_lengths);
  visit("query_frames", settings.query_frames);
  visit("clustered_hits", settings.clustered_hits);
  visit("seconds", settings.seconds);
  visit("changed_bits", settings.changed_bits);
  visit("descriptor_length", settings.descriptor_length);
  visit("precision", settings.precision);
  visit("lsh", settings.lsh);
}

/// Generated codes. Every method is checked against the definition before it is timed. Throws
/// Error(usage) for settings out of range, Error(expectation) if a distance differs.
BenchResult bench_matching(const MatchingBenchSettings& settings, uint64_t seed,
                           const RowKernels& kernels, const Monitor& monitor);

/// Speed-up of FastABLE over OpenABLE of each case, beside the paper's where it has one, and the
/// plots of its figures.
void add_matching_comparisons(BenchResult& result, const MatchingBenchSettings& settings);

}  // namespace vpr
