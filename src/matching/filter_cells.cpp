#include "matching/filter_cells.h"

#include <algorithm>
#include <cassert>

namespace vpr {

FilterCells find_cells(const FrameDistances& distances, double least_change) {
  FilterCells cells;
  for (const FrameRun& run : distances.train_runs) {
    const DescriptorRows& rows = distances.train[run.sequence].rows;
    cells.frames.resize(cells.frames.size() + kLongestStep, 0);
    CellRun& added =
        cells.runs.emplace_back(CellRun{cells.size(), 0, run.sequence, run.first + run.count});
    size_t last = run.first_in_sequence;
    for (size_t k = 0; k < run.count; ++k) {
      const size_t frame = run.first_in_sequence + k;
      if (k > 0 && frame_distance(rows, last, frame) < least_change) continue;
      last = frame;
      cells.frames.push_back(static_cast<uint32_t>(run.first + k));
    }
    added.count = cells.size() - added.first;
    cells.places += added.count;
  }
  return cells;
}

const CellRun& run_of(const FilterCells& cells, size_t cell) {
  const auto behind = std::upper_bound(cells.runs.begin(), cells.runs.end(), cell,
                                       [](size_t c, const CellRun& run) { return c < run.first; });
  assert(behind != cells.runs.begin());
  return *std::prev(behind);
}

size_t view_end(const FilterCells& cells, const CellRun& run, size_t cell) {
  return cell + 1 < run.first + run.count ? cells.frames[cell + 1] : run.frames_end;
}

}  // namespace vpr
