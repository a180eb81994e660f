// Verification and timing of matchers by database size, window length and query length (the paper's
// tables 5 to 7 and figures 12, 16 and 17).
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/monitor.h"
#include "bench/bench_result.h"
#include "match/rows.h"
#include "match/zscore_model.h"

namespace vpr {

/// One database and one query, as codes and as distances.
struct MatchingCase {
  std::span<const LdbCode> train_codes;  ///< empty for other descriptors
  std::vector<LdbCode> query_codes;
  MatchSettings settings;
  FrameDistances distances;

  MatchingCase(const std::vector<LdbCode>& train_frames, std::vector<LdbCode> query_frames,
               const MatchSettings& match);
  /// For descriptors of any kind, which must outlive this object.
  MatchingCase(const DescriptorRows& train, const DescriptorRows& query,
               const MatchSettings& match);
  MatchingCase(const MatchingCase&) = delete;
  size_t rows() const { return distances.query_frames - settings.window_length + 1; }
};

/// An entry of the table of timed methods.
struct MatchingTimer {
  std::string_view name;
  std::string_view summary;
  bool needs_codes = false;  ///< compares LDB codes only
  /// Milliseconds per query frame. Adds values and a note to the row.
  void (*measure)(const MatchingCase&, const Effort&, const Monitor&, BenchRow&);
};

/// All entries, in the order of help and reports.
std::span<const MatchingTimer> matching_timers();
/// Recomputes a few hundred random cells of every exact method with the reference implementation.
/// Throws Error(expectation) if a cell differs.
void check_methods(const MatchingCase& example, const std::vector<std::string>& methods,
                   const Monitor& monitor);

/// Settings of vpr-bench matching, which times every method with every combination of the values.
struct MatchingBenchSettings {
  std::vector<std::string> methods = {"fastable-online", "fastable", "zscore", "openable"};
  std::vector<uint64_t> databases = {500, 1000, 2000, 4000, 8000};  ///< frames
  std::vector<uint64_t> window_lengths = {20, 40, 60, 80};          ///< c_l
  std::vector<uint64_t> query_frames = {1000};
  uint64_t clustered_recognitions = 1'000'000;  ///< 0: clustering is not timed
  double seconds = 0.3;                         ///< per measurement
  /// number of bits in which query frames differ from training frames
  uint64_t changed_bits = 150;
  /// Length of generated vectors, compared by 1 - cos; 0: LDB codes. Methods that need LDB codes
  /// are then omitted.
  uint64_t descriptor_length = 0;
  uint64_t precision = 16;             ///< bits per value of these vectors: 16 or 8
  uint64_t ring_bytes = 512ULL << 20;  ///< maximum memory of FastABLE's ring
  LshSettings lsh = {};
};

template <class Visitor>
void visit_fields(MatchingBenchSettings& settings, Visitor&& visit) {
  visit("methods", settings.methods);
  visit("databases", settings.databases);
  visit("c_l", settings.window_lengths);
  visit("query_frames", settings.query_frames);
  visit("clustered_recognitions", settings.clustered_recognitions);
  visit("seconds", settings.seconds);
  visit("changed_bits", settings.changed_bits);
  visit("descriptor_length", settings.descriptor_length);
  visit("precision", settings.precision);
  visit("ring_bytes", settings.ring_bytes);
  visit("lsh", settings.lsh);
}

/// Codes of a recording, used instead of generated ones.
struct RecordedCodes {
  std::vector<LdbCode> train;
  std::vector<LdbCode> query;
};

/// Times each method on the first frames of the recording or on generated codes, after it has
/// compared every method with the reference implementation. Lists databases that exceed the memory
/// or the recording in left_out. Throws Error(usage) for settings out of range, Error(expectation)
/// if a distance differs.
BenchResult bench_matching(const MatchingBenchSettings& settings,
                           const std::optional<RecordedCodes>& recorded, uint64_t seed,
                           const RowKernels& kernels, const Monitor& monitor);

/// Adds the speed-up of FastABLE over OpenABLE to the rows, and the charts.
void add_matching_comparisons(BenchResult& result, const MatchingBenchSettings& settings);

}  // namespace vpr
