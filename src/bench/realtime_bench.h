// Latency of a live query, from file to result, for a recording played at its frame rate.
#pragma once

#include <string>

#include "bench/bench_result.h"
#include "run/live_query.h"
#include "sequence/sequence_source.h"

namespace vpr {

struct RealtimeBenchSettings {
  std::string method = "fastable";  ///< or "filter"
  Score score = Score::raw;
  double rate_hz = 10;
  uint64_t frames = 100;        ///< maximum number of query frames
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

/// The settings of the timed query: matches are accepted by margin.
ResolvedSettings live_settings(const RealtimeBenchSettings& settings);

/// Times the steps of vpr-query --follow: decode and describe a frame, LiveQuery::take. Each frame
/// is due at a fixed time and starts no earlier. Its latency is counted from that time to the
/// result, so a late frame delays the next ones. Sleeps in between. The row has latency percentiles
/// (50, 95, 99, 100), missed deadlines (latency above one period) and the share of a core. Throws
/// Error(usage) for a query that is not a folder or list of images and for settings out of range;
/// also throws as describe_frames and LiveQuery do.
BenchResult bench_realtime(const SequenceDatabase& database, const SequenceSource& query,
                           const RealtimeBenchSettings& settings, const QueryResources& resources,
                           const Monitor& monitor);

}  // namespace vpr
