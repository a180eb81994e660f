// The runs of readable frames that contain windows.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "describe/descriptor_rows.h"

namespace vpr {

/// Consecutive readable frames of one sequence. Windows lie within a run and never cross its end:
/// an unreadable frame and the end of a sequence end a run.
struct FrameRun {
  size_t first = 0;  ///< in all frames of the set
  size_t count = 0;
  size_t sequence = 0;
  size_t first_in_sequence = 0;

  size_t windows(size_t window_length) const {
    return count < window_length ? 0 : count - window_length + 1;
  }
};

/// The runs of one sequence between its unreadable frames.
std::vector<FrameRun> readable_runs(const DescriptorSpan& sequence);

/// The runs of several sequences, one after the other.
std::vector<FrameRun> readable_runs(std::span<const DescriptorSpan> sequences);

/// The number of frames of all sequences, including unreadable ones.
size_t count_frames(std::span<const DescriptorSpan> sequences);

/// The number of windows of `window_length` frames in all runs; 0 if every run is shorter.
size_t count_windows(std::span<const FrameRun> runs, size_t window_length);

/// Whether each of `frames` frames is in a run: 1 or 0.
std::vector<uint8_t> readable_flags(std::span<const FrameRun> runs, size_t frames);

}  // namespace vpr
