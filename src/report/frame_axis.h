// Frames on an axis: sequence after sequence, with round ticks and the sequences' names.
#pragma once

#include <string>
#include <vector>

#include "evaluation/score_matrix.h"

namespace vpr {

/// A stretch of the axis: frames first_frame .. first_frame + count - 1 of a sequence, the first at
/// the position `at`.
struct FrameBand {
  std::string name;
  uint32_t sequence = 0;
  size_t at = 0;
  size_t first_frame = 0;
  size_t count = 0;
};

/// All frames of the searched training sequences, one behind the other.
std::vector<FrameBand> frame_bands(const ScoreLayout& layout);

/// The columns of the layout's matrix: a window stands at its anchor, the frame it is judged at.
std::vector<FrameBand> column_bands(const ScoreLayout& layout);

/// The rows of the layout's matrix, as one band without a name.
std::vector<FrameBand> row_bands(const ScoreLayout& layout);

/// Frames of all bands.
size_t length_of(const std::vector<FrameBand>& bands);

/// Where a frame stands on the axis; it is in one of the bands, which are by sequence.
size_t position_of(const std::vector<FrameBand>& bands, const FrameMatch& match);

/// A mark on an axis of frames.
struct AxisTick {
  double position = 0;  ///< of the middle of the frame
  size_t frame = 0;
};

/// Ticks at round frames (1, 2 or 5 times a power of ten apart) and at the first of each band, at
/// most about `most`: of two that are near each other the one at a band's start stays.
std::vector<AxisTick> ticks_of(const std::vector<FrameBand>& bands, size_t most);

/// The smallest of 1, 2, 5, 10, 20, ... that divides `length` into at most `most` parts; most is at
/// least 1.
size_t round_step(size_t length, size_t most);

}  // namespace vpr
