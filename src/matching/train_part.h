// The training windows that one of several processes compares, and the frames that it holds.
#pragma once

#include <span>
#include <vector>

#include "base/share.h"
#include "matching/frame_distances.h"
#include "matching/rows.h"

namespace vpr {

/// By training sequence. A process has the windows that begin at its frames; all processes have as
/// many frames, whatever sequence they are of, and hold the window_length - 1 behind them, too.
struct TrainPart {
  std::vector<ItemRange> own;
  std::vector<ItemRange> held;
};

/// For windows of up to `longest` frames. Of one process: all frames.
TrainPart own_windows(std::span<const DescriptorSpan> train, size_t longest, const Share& share);

/// The distances of a query to the frames that a process holds; the runs that they are in are named
/// as in the whole sequences, and rows are centred over all frames of `centred_over`. A step of all
/// processes, after which each row's total is known.
FrameDistances part_distances(std::span<const DescriptorSpan> train, const TrainPart& part,
                              const DescriptorSpan& query,
                              std::span<const DescriptorSpan> centred_over, const Share& share);

/// Hands on the cells of windows that begin at the process's frames: shorter windows than the
/// longest are also found where they begin behind them.
RowConsumer own_rows(const TrainPart& part, RowConsumer consume);

}  // namespace vpr
