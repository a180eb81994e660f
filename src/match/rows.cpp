#include "match/rows.h"

#include <algorithm>

namespace vpr {
namespace {

// The first run that ends after `frame`.
std::vector<FrameRun>::const_iterator run_from(const std::vector<FrameRun>& runs, size_t frame) {
  return std::partition_point(runs.begin(), runs.end(),
                              [&](const FrameRun& run) { return run.first + run.count <= frame; });
}

}  // namespace

ScoreRow part_of_row(const ScoreRow& row, size_t first, size_t count) {
  ScoreRow part = row;
  part.train_window += first;
  part.scores = row.scores.subspan(first, count);
  if (!row.rates.empty()) part.rates = row.rates.subspan(first, count);
  return part;
}

void emit_row(const FrameDistances& frames, size_t window_length, size_t query_end, size_t first,
              std::span<const uint32_t> sums, const RowConsumer& consume) {
  const size_t known = frames.past.empty() ? frames.train_frames : frames.past[query_end];
  const size_t end = std::min(first + sums.size(), known);
  for (auto run = run_from(frames.train_runs, first);
       run != frames.train_runs.end() && run->first < end; ++run) {
    const size_t from = std::max(first, run->first + window_length - 1);
    const size_t to = std::min(end, run->first + run->count);
    if (from >= to) continue;
    consume({query_end + 1 - window_length, run->sequence,
             run->first_in_sequence + (from + 1 - window_length - run->first),
             sums.subspan(from - first, to - from)});
  }
}

std::vector<ScoreRow> whole_row(const FrameDistances& frames, size_t window_length,
                                size_t query_end, std::span<const uint32_t> sums) {
  std::vector<ScoreRow> row;
  emit_row(frames, window_length, query_end, 0, sums,
           [&](const ScoreRow& piece) { row.push_back(piece); });
  return row;
}

std::optional<size_t> least_lag(const FrameDistances& frames) {
  if (frames.past.empty()) return std::nullopt;
  size_t least = frames.query_frames;
  for (size_t query = 0; query < frames.query_frames; ++query)
    if (frames.past[query] > 0) least = std::min(least, query + 1 - frames.past[query]);
  return least;
}

bool any_window_pair(const FrameDistances& frames, size_t window_length) {
  return count_windows(frames.train_runs, window_length) > 0 &&
         count_windows(frames.query_runs, window_length) > 0;
}

bool ends_window(const FrameDistances& frames, size_t window_length, size_t frame) {
  const auto run = run_from(frames.query_runs, frame);
  return run != frames.query_runs.end() && frame + 1 >= run->first + window_length;
}

}  // namespace vpr
