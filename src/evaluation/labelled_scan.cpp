#include "evaluation/labelled_scan.h"

#include <algorithm>
#include <utility>

namespace vpr {
namespace {

// Whether frames are labelled same or ignore, or at most `width` before or behind one that is.
std::vector<uint8_t> near_place(const std::vector<PlaceLabel>& labels, size_t width) {
  std::vector<uint8_t> near(labels.size(), 0);
  size_t marked = 0;  // frames in front of it are done
  for (size_t frame = 0; frame < labels.size(); ++frame) {
    if (labels[frame] == PlaceLabel::different) continue;
    const size_t first = std::max(marked, frame - std::min(frame, width));
    const size_t end = std::min(labels.size(), frame + width + 1);
    for (size_t f = first; f < end; ++f) near[f] = 1;
    marked = end;
  }
  return near;
}

}  // namespace

LabelledScan::LabelledScan(const GroundTruth& truth, Elsewhere elsewhere, size_t window_length,
                           size_t query_windows, const RowKernels& kernels)
    : truth_(truth),
      widths_(elsewhere.widths),
      window_length_(window_length),
      untrained_(std::move(elsewhere), query_windows, kernels) {}

void LabelledScan::operator()(const ScoreRow& row) {
  const size_t count = row.scores.size();
  const size_t width = widths_[row.sequence];
  const size_t anchor = window_length_ - 1;
  std::vector<PlaceLabel> labels(row.train_window + anchor + count + width);
  truth_.label_row(row.query_window + anchor, row.sequence, labels);
  const std::vector<uint8_t> near = near_place(labels, width);
  const size_t first = row.train_window + anchor;
  for (size_t begin = 0; begin < count; ++begin) {
    if (near[first + begin] != 0) continue;
    size_t end = begin;
    while (end < count && near[first + end] == 0) ++end;
    untrained_(part_of_row(row, begin, end - begin));
    begin = end;
  }
}

std::vector<std::optional<uint32_t>> LabelledScan::result() const {
  return untrained_.result().margins;
}

}  // namespace vpr
