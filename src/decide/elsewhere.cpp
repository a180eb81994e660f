#include "decide/elsewhere.h"

#include <algorithm>

namespace vpr {

namespace {

constexpr size_t kSampledFrames = 10'000;

// Of a row, the parts at least `gap` before or behind the query window.
std::vector<ScoreRow> far_parts(std::span<const ScoreRow> row, size_t gap) {
  std::vector<ScoreRow> parts;
  for (const ScoreRow& piece : row) {
    const size_t begin = piece.train_window;
    const size_t end = begin + piece.scores.size();
    const size_t before = piece.query_window + 1 > gap ? piece.query_window + 1 - gap : 0;
    const size_t to = std::clamp(before, begin, end);
    const size_t from = std::clamp(piece.query_window + gap, begin, end);
    if (to > begin) parts.push_back(part_of_row(piece, 0, to - begin));
    if (from < end) parts.push_back(part_of_row(piece, from - begin, end - from));
  }
  return parts;
}

constexpr size_t kFramesOfStretch = 1000;

Stretch stretch_of(const DescriptorSpan& walk, size_t first, size_t count) {
  Stretch stretch{first, count, {}};
  for (const size_t frame : walk.unreadable)
    if (frame >= first && frame < first + count) stretch.unreadable.push_back(frame - first);
  return stretch;
}

}  // namespace

size_t half_width(const DescriptorSpan& walk, const Monitor& monitor) {
  const size_t frames = walk.rows.size();
  const double half = mean_distance_within(frame_distances({&walk, 1}, walk)) / 2;
  const std::vector<uint8_t> readable = readable_flags(readable_runs(walk), frames);
  const size_t step = std::max<size_t>(1, frames / kSampledFrames);
  for (size_t apart = 1; apart < frames; ++apart) {
    check_stop(monitor);
    uint64_t sum = 0;
    uint64_t count = 0;
    for (size_t i = 0; i + apart < frames; i += step) {
      if (readable[i] == 0 || readable[i + apart] == 0) continue;
      sum += frame_distance(walk.rows, i, i + apart);
      ++count;
    }
    if (count > 0 && static_cast<double>(sum) >= half * static_cast<double>(count)) return apart;
  }
  return std::max<size_t>(frames, 1);
}

void match_far(const DescriptorSpan& walk, size_t window_length, size_t gap,
               const WalkMatcher& match, const WholeRowConsumer& consume, size_t most_pairs) {
  const size_t frames = walk.rows.size();
  if (frames < window_length || gap > frames - window_length) return;
  const FrameDistances own = frame_distances({&walk, 1}, {walk.rows.first(0), {}});
  for (const Stretch& stretch : choose_stretches(walk, frames, window_length, most_pairs))
    match(own.of_query(stretch.of(walk)), [&](std::span<const ScoreRow> row) {
      std::vector<ScoreRow> moved(row.begin(), row.end());
      for (ScoreRow& piece : moved) piece.query_window += stretch.first;
      const std::vector<ScoreRow> far = far_parts(moved, gap);
      if (!far.empty()) consume(far);
    });
}

std::vector<Stretch> choose_stretches(const DescriptorSpan& walk, size_t other_frames,
                                      size_t window_length, size_t most_pairs) {
  const size_t frames = walk.rows.size();
  const size_t length = std::max(kFramesOfStretch, 2 * window_length);
  if (length >= frames || frames <= most_pairs / other_frames) return {stretch_of(walk, 0, frames)};
  const size_t count = std::max<size_t>(2, most_pairs / other_frames / length);
  std::vector<Stretch> stretches;
  for (size_t s = 0; s < count; ++s)
    stretches.push_back(stretch_of(walk, s * (frames - length) / (count - 1), length));
  return stretches;
}

}  // namespace vpr
