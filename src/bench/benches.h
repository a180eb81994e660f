// The benchmarks of vpr-bench: matching, description, training, FAB-MAP, and a live query.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "bench/bench_result.h"
#include "fabmap/local_features.h"
#include "match/match.h"
#include "query/live_query.h"
#include "recordings/sequence_source.h"

namespace vpr {

/// The distances of a query to a database, and how they are matched.
struct MatchingCase {
  MatchSettings settings;
  FrameDistances distances;

  size_t rows() const { return distances.query_frames - settings.window_length + 1; }
};

/// Both sides must outlive the case.
MatchingCase make_case(const DescriptorRows& train, const DescriptorRows& query,
                       const MatchSettings& settings);

/// Recomputes a few hundred random cells of every exact method with the reference implementation.
/// Throws Error(expectation) if a cell differs.
void check_methods(const MatchingCase& example, const std::vector<std::string>& methods,
                   const Monitor& monitor);

/// Settings of vpr-bench matching, which times every method with every combination of the values.
struct MatchingBenchSettings {
  std::vector<std::string> methods = {"fastable-online", "fastable", "zscore", "openable"};
  std::vector<uint64_t> databases = {500, 1000, 2000, 4000, 8000};
  std::vector<uint64_t> window_lengths = {20, 40, 60, 80};
  std::vector<uint64_t> query_frames = {1000};
  uint64_t clustered_recognitions = 1'000'000;
  double seconds = 0.3;
  uint64_t changed_bits = 150;
  uint64_t descriptor_length = 0;
  uint64_t precision = 16;
  uint64_t ring_bytes = 512ULL << 20;
  LshSettings lsh = {};
};

template <class Visitor>
void visit_fields(MatchingBenchSettings& settings, Visitor&& visit) {
  visit("methods", settings.methods, "Methods to time, as listed by vpr-bench matching --help.");
  visit("databases", settings.databases, "Database sizes, in frames.");
  visit("c_l", settings.window_lengths, "Window lengths.");
  visit("query_frames", settings.query_frames, "Query lengths, in frames.");
  visit("clustered_recognitions", settings.clustered_recognitions,
        "Recognitions to cluster, or 0.");
  visit("seconds", settings.seconds, "Least time of a measurement.", above(0));
  visit("changed_bits", settings.changed_bits, "Bits that differ between matching frames.");
  visit("descriptor_length", settings.descriptor_length,
        "Dimensions of generated vectors that replace LDB codes; 0: LDB codes.");
  visit("precision", settings.precision, "Bits per value: 8 or 16.");
  visit("ring_bytes", settings.ring_bytes,
        "Bytes of the ring of window distances; a larger database is searched without it.");
  visit("lsh", settings.lsh, "Settings of method lsh.");
}

/// Codes of a recording, used instead of generated ones.
struct RecordedCodes {
  std::vector<LdbCode> train;
  std::vector<LdbCode> query;
};

/// Times each method on the first frames of the recording or on generated codes, after it has
/// compared every method with the reference implementation. Adds the speed-up of FastABLE over
/// OpenABLE to the rows, and charts. Lists databases that exceed the memory
/// or the recording in left_out. Throws Error(usage) for settings out of range, Error(expectation)
/// if a distance differs.
BenchResult bench_matching(const MatchingBenchSettings& settings,
                           const std::optional<RecordedCodes>& recorded, uint64_t seed,
                           const Monitor& monitor);

/// Settings of vpr-bench describe.
struct DescribeBenchSettings {
  std::vector<std::string> feature_kinds = {"surf", "sift", "kaze", "akaze", "orb", "brisk"};
  uint64_t frames = 20;
  double seconds = 1;
  FeatureSettings feature_settings;
};

VPR_FIELDS(DescribeBenchSettings, (feature_kinds, "Local features to time."),
           (frames, "Frames to describe."), (seconds, "Least time of a measurement.", above(0)),
           (feature_settings, "Feature settings."))

/// `images`: a folder or list of images; without it, generated 640x480 JPEG files in memory.
BenchResult bench_describe(const DescribeBenchSettings& settings,
                           const std::optional<SequenceSource>& images, uint64_t seed,
                           const Monitor& monitor);

/// Settings of vpr-bench fabmap, which times every variant with every combination of the values.
struct FabmapBenchSettings {
  std::vector<std::string> variants = {"fabmap2", "fbo", "lut", "fabmap1"};
  std::vector<uint64_t> place_counts = {10, 100, 1000, 10'000, 100'000};
  std::vector<uint64_t> words = {10'000};
  std::vector<uint64_t> words_per_frame = {200};
  uint64_t pretrain_frames = 1000;
  uint64_t descriptors = 20'000;
  uint64_t iterations = 20;
  double seconds = 0.3;
  double slow_limit = 1'000'000'000;
  double frame_ms = 0;
};

VPR_FIELDS(FabmapBenchSettings, (variants, "Variants to time."),
           (place_counts, "Numbers of places."), (words, "Vocabulary sizes."),
           (words_per_frame, "Mean number of words per frame."),
           (pretrain_frames, "Frames of the tree."),
           (descriptors, "Descriptors that k-means clusters; 0: none."),
           (iterations, "Largest number of k-means steps."),
           (seconds, "Least time of a measurement.", above(0)),
           (slow_limit, "Largest product of places and words at which slow variants are timed."),
           (frame_ms, "Time of a frame's features, included in frames per second, in ms."))

/// Words are drawn uniformly. Before a variant is timed, its results are compared with the
/// reference implementation on a hundred places. Also times the new place, the normalization of the
/// posterior, the whole query of vpr-query, and the training of the Chow-Liu tree.
BenchResult bench_fabmap(const FabmapBenchSettings& settings, uint64_t seed,
                         const Monitor& monitor);

/// Settings of vpr-bench training.
struct TrainingBenchSettings {
  std::vector<uint64_t> databases = {5000, 10'000, 20'000, 40'000};
  uint64_t descriptor_length = 464;
  uint64_t precision = 16;
};

VPR_FIELDS(TrainingBenchSettings, (databases, "Database sizes, in frames."),
           (descriptor_length, "Dimensions of generated vectors."),
           (precision, "Bits per value: 8 or 16."))

/// Times what training computes of descriptors, once per database: statistics, exclusion radii,
/// overlapping sequences and passes. Databases are one generated walk without repetition. The rows
/// have the processor time of all threads, the exponent of its growth since the row before, and the
/// peak memory. Throws Error(usage) for settings out of range.
BenchResult bench_training(const TrainingBenchSettings& settings, uint64_t seed,
                           const Monitor& monitor);

struct RealtimeBenchSettings {
  std::string method = "fastable";
  Score score = Score::raw;
  double rate_hz = 10;
  uint64_t frames = 100;
  uint64_t window_length = 40;
};

template <class Visitor>
void visit_fields(RealtimeBenchSettings& settings, Visitor&& visit) {
  visit("method", settings.method, "Matching method: fastable or filter.");
  visit("score", settings.score, "Summands of window scores.");
  visit("rate", settings.rate_hz, "Frame rate of the query, in Hz.");
  visit("query_frames", settings.frames, "Frames of the query at most.");
  visit("c_l", settings.window_length, "Window length in frames.");
}

/// Times the steps of vpr-query live, which accepts matches by margin: decode and describe a frame,
/// LiveQuery::take. Each frame is due at a fixed time and starts no earlier. Its latency is counted
/// from that time to the result, so a late frame delays the next ones. Sleeps in between. The row
/// has latency percentiles (50, 95, 99, 100), missed deadlines (latency above one period) and the
/// share of a core. Throws Error(usage) for a query that is not a folder or list of images and for
/// settings out of range; also throws as open_database, describe_frames and LiveQuery do.
BenchResult bench_realtime(const std::string& database_path, const SequenceSource& query,
                           const RealtimeBenchSettings& settings, const QueryResources& resources,
                           const Monitor& monitor);

}  // namespace vpr
