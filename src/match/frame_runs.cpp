#include "match/frame_runs.h"

#include <algorithm>

namespace vpr {
namespace {

// Appends the runs of a sequence between its unreadable frames.
void append_runs(std::vector<FrameRun>& runs, size_t first, size_t sequence,
                 const DescriptorSpan& span) {
  size_t start = 0;
  const auto close = [&](size_t end) {
    if (end > start) runs.push_back({first + start, end - start, sequence, start});
    start = end + 1;
  };
  for (const size_t frame : span.unreadable) close(frame);
  close(span.rows.size());
}

}  // namespace

std::vector<FrameRun> readable_runs(const DescriptorSpan& sequence) {
  return readable_runs({&sequence, 1});
}

std::vector<FrameRun> readable_runs(std::span<const DescriptorSpan> sequences) {
  std::vector<FrameRun> runs;
  size_t first = 0;
  for (size_t s = 0; s < sequences.size(); ++s) {
    append_runs(runs, first, s, sequences[s]);
    first += sequences[s].rows.size();
  }
  return runs;
}

size_t count_frames(std::span<const DescriptorSpan> sequences) {
  size_t frames = 0;
  for (const DescriptorSpan& sequence : sequences) frames += sequence.rows.size();
  return frames;
}

size_t count_windows(std::span<const FrameRun> runs, size_t window_length) {
  size_t windows = 0;
  for (const FrameRun& run : runs) windows += run.windows(window_length);
  return windows;
}

std::vector<uint8_t> readable_flags(std::span<const FrameRun> runs, size_t frames) {
  std::vector<uint8_t> readable(frames, 0);
  for (const FrameRun& run : runs)
    std::fill_n(readable.begin() + static_cast<ptrdiff_t>(run.first), run.count, uint8_t{1});
  return readable;
}

}  // namespace vpr
