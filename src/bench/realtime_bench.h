// Does it keep up? A recording is replayed at its rate, frame by frame, from file to recognition.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/bench_result.h"
#include "database/fabmap_database.h"
#include "database/sequence_database.h"
#include "images/sequence.h"
#include "matching/rows.h"
#include "recognition/query_settings.h"

namespace vpr {

/// What vpr-bench realtime asks for.
struct RealtimeBenchSettings {
  std::string method = "fastable";  ///< of databases of sequences: or "filter"
  double rate_hz = 10;
  uint64_t frames = 100;             ///< of the query at most
  uint64_t window_length = 40;       ///< c_l
  std::vector<std::string> rates;    ///< of windows, as of vpr-query; empty: 1
  double share_percent = 10;         ///< of one core, that matching may take
  uint64_t most_frames = 2'000'000;  ///< of the largest database that is tried
};

template <class Visitor>
void visit_fields(RealtimeBenchSettings& settings, Visitor&& visit) {
  visit("method", settings.method);
  visit("rate", settings.rate_hz);
  visit("frames", settings.frames);
  visit("c_l", settings.window_length);
  visit("rates", settings.rates);
  visit("share", settings.share_percent);
  visit("most_frames", settings.most_frames);
}

/// What is done with a decoded grey frame.
using FrameWork = std::function<void(const cv::Mat&)>;

/// LDB, and what settings.method does with a frame: one step of FastABLE over all sequences, of
/// windows of settings.rates if there are any, and the best match of each; or standardized scores
/// and one step of the filter over places and rates. The database must outlive it. Throws
/// Error(usage) for illumination-invariant codes, which need colour, for rates that there are not,
/// and for the filter if there are rates, or the database has no statistics.
FrameWork sequence_work(const SequenceDatabase& database, const RealtimeBenchSettings& settings,
                        const RowKernels& kernels);

/// Features, words, likelihoods and the posterior. The database must outlive it.
FrameWork fabmap_work(const FabmapDatabase& database, const FabmapQuerySettings& settings);

/// Each frame is due at its time and starts no earlier; its latency counts from then to the end of
/// the work, decoding included, so that a late frame delays the next ones. Sleeps in between: this
/// takes as long as the recording. The row has latency percentiles (50, 95, 99, 100), missed
/// deadlines (latency above one period) and the share of a core. Throws Error(usage) for a video.
BenchResult bench_realtime(const Sequence& query, const FrameWork& work,
                           const RealtimeBenchSettings& settings, const Monitor& monitor);

/// The largest database of generated codes whose online matching takes at most the given share of
/// one core at this rate; adds a row for each size tried.
void find_largest_database(BenchResult& result, const RealtimeBenchSettings& settings,
                           const RowKernels& kernels, uint64_t seed, const Monitor& monitor);

}  // namespace vpr
