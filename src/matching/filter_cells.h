// The places that the filter tells apart: views of the training sequences.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "matching/frame_distances.h"

namespace vpr {

/// No step of the filter is longer: so many cells in front of a run stand for no place, and nothing
/// comes in from there.
inline constexpr size_t kLongestStep = 3;

/// The cells of a run of readable training frames.
struct CellRun {
  size_t first = 0;  ///< cell
  size_t count = 0;
  size_t sequence = 0;
  size_t frames_end = 0;  ///< the frame behind the run
};

struct FilterCells {
  /// The first frame of every cell's view, among all training frames. Means nothing for a cell that
  /// is no place.
  std::vector<uint32_t> frames;
  std::vector<CellRun> runs;  ///< rising
  size_t places = 0;          ///< cells that are one

  size_t size() const { return frames.size(); }
};

/// Every run begins with a view, and a frame that differs by at least least_change from the last
/// view of its run is one.
FilterCells find_cells(const FrameDistances& distances, double least_change);

/// The run that a place is in.
const CellRun& run_of(const FilterCells& cells, size_t cell);

/// The frame behind the view of a place of the run.
size_t view_end(const FilterCells& cells, const CellRun& run, size_t cell);

}  // namespace vpr
