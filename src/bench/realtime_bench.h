// Latency of a live query: a recording is replayed at its frame rate, from file to result.
#pragma once

#include <string>

#include "bench/bench_result.h"
#include "run/live_query.h"
#include "sequence/sequence.h"

namespace vpr {

/// Settings of vpr-bench realtime.
struct RealtimeBenchSettings {
  std::string method = "fastable";  ///< or "filter"
  Score score = Score::raw;
  double rate_hz = 10;
  uint64_t frames = 100;        ///< of the query at most
  uint64_t window_length = 40;  ///< c_l
};

template <class Visitor>
void visit_fields(RealtimeBenchSettings& settings, Visitor&& visit) {
  visit("method", settings.method);
  visit("score", settings.score);
  visit("rate", settings.rate_hz);
  visit("frames", settings.frames);
  visit("c_l", settings.window_length);
}

/// The settings of the query that is timed: matches are accepted by margin.
ResolvedSettings live_settings(const RealtimeBenchSettings& settings);

/// Times the steps of vpr-query --follow: decode and describe a frame, LiveQuery::take. A frame is
/// due at its time and starts no earlier; its latency counts from then to the result, so that a
/// late frame delays the next ones. Sleeps in between. The row has latency percentiles (50, 95, 99,
/// 100), missed deadlines (latency above one period) and the share of a core. Throws Error(usage)
/// for a query that is not a folder or list of images and for settings out of range, and what
/// describe_frames and LiveQuery throw.
BenchResult bench_realtime(const SequenceDatabase& database, const Sequence& query,
                           const RealtimeBenchSettings& settings, const QueryResources& resources,
                           const Monitor& monitor);

}  // namespace vpr
