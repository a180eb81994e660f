// Does it keep up? A recording is replayed at its rate, frame by frame, from file to recognition.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/bench_result.h"
#include "descriptors/descriptor_rows.h"
#include "images/sequence.h"
#include "matching/rows.h"

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

/// What is done with a frame, a sequence of it alone.
using FrameWork = std::function<void(const Sequence& frame)>;

/// Each frame is due at its time and starts no earlier; its latency counts from then to the end of
/// the work, decoding included, so that a late frame delays the next ones. Sleeps in between: this
/// takes as long as the recording. The row has latency percentiles (50, 95, 99, 100), missed
/// deadlines (latency above one period) and the share of a core. Throws Error(usage) for a video,
/// and what the work throws.
BenchResult bench_realtime(const Sequence& query, const FrameWork& work,
                           const RealtimeBenchSettings& settings, const Monitor& monitor);

/// The largest database whose online matching takes at most the given share of one core at this
/// rate, of generated LDB codes, or, unless `like` is empty, of these descriptors again and again;
/// adds a row for each size tried.
void find_largest_database(BenchResult& result, const RealtimeBenchSettings& settings,
                           const RowKernels& kernels, uint64_t seed, const DescriptorRows& like,
                           const Monitor& monitor);

}  // namespace vpr
