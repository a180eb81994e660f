// The stretches of readable frames in which windows may lie.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "describe/descriptor_rows.h"

namespace vpr {

/// Readable frames in a row, of one sequence. Windows lie within a run and never cross its end: an
/// unreadable frame, like the end of a sequence, ends a run.
struct FrameRun {
  size_t first = 0;  ///< among all frames of the set
  size_t count = 0;
  size_t sequence = 0;
  size_t first_in_sequence = 0;

  size_t windows(size_t window_length) const {
    return count < window_length ? 0 : count - window_length + 1;
  }
};

/// The stretches of one sequence between its unreadable frames.
std::vector<FrameRun> readable_runs(const DescriptorSpan& sequence);

/// The same of several sequences, one after the other.
std::vector<FrameRun> readable_runs(std::span<const DescriptorSpan> sequences);

/// Frames of all sequences, with those that can't be read.
size_t count_frames(std::span<const DescriptorSpan> sequences);

/// Windows of `window_length` frames in all runs; 0 where every run is shorter.
size_t count_windows(std::span<const FrameRun> runs, size_t window_length);

/// Whether each of `frames` frames is in a run: 1 or 0.
std::vector<uint8_t> readable_flags(std::span<const FrameRun> runs, size_t frames);

}  // namespace vpr
