#include "evaluation/score_layout.h"

#include <algorithm>
#include <cassert>

#include <fmt/format.h>

#include "base/error.h"
#include "evaluation/counts.h"

namespace vpr {

const ScoreLayout::Columns* ScoreLayout::columns_of(uint32_t sequence) const {
  const auto found = std::ranges::lower_bound(columns, sequence, {}, &Columns::sequence);
  return found != columns.end() && found->sequence == sequence ? &*found : nullptr;
}

size_t row_count(const ScoreLayout& layout) {
  const size_t frames = layout.scope.query_frames;
  return frames < layout.window_length ? 0 : frames - layout.window_length + 1;
}

size_t column_count(const ScoreLayout& layout) {
  return layout.columns.empty() ? 0 : layout.columns.back().first + layout.columns.back().count;
}

ScoreLayout layout_of(const ScoreMatrix& matrix, size_t window_length) {
  assert(window_length >= 1);
  ScoreLayout layout;
  layout.window_length = window_length;
  layout.scope.query_frames = matrix.queries() + window_length - 1;
  layout.scope.sequences = {{"references", matrix.references() + window_length - 1, true}};
  layout.columns = {{0, 0, matrix.references()}};
  return layout;
}

ScoreLayout layout_of(const Result& result) {
  ScoreLayout layout;
  layout.window_length = result.window_length();
  layout.scope = scope_of(result);
  for (size_t t = 0; t < result.targets.size(); ++t) {
    const Target& target = result.targets[t];
    if (!target.searched || target.frames < layout.window_length) continue;
    layout.columns.push_back(
        {static_cast<uint32_t>(t), column_count(layout), target.frames - layout.window_length + 1});
  }
  return layout;
}

void require_fit(const ScoreMatrix& matrix, const ScoreLayout& layout) {
  if (matrix.queries() == row_count(layout) && matrix.references() == column_count(layout)) return;
  throw Error(
      ErrorKind::data,
      fmt::format("the scores are {} x {}, and the result has {} query windows and {} "
                  "training windows; give the matrix that was saved with it",
                  matrix.queries(), matrix.references(), row_count(layout), column_count(layout)));
}

void label_row(const GroundTruth& truth, const ScoreLayout& layout, size_t row,
               std::vector<PlaceLabel>& labels) {
  labels.assign(column_count(layout), PlaceLabel::different);
  const size_t back = layout.window_length - 1;  // from a window's anchor to its first frame
  std::vector<PlaceLabel> frames;
  for (const ScoreLayout::Columns& columns : layout.columns) {
    frames.resize(columns.count + back);
    truth.label_row(layout.anchor(row), columns.sequence, frames);
    std::copy(frames.begin() + static_cast<std::ptrdiff_t>(back), frames.end(),
              labels.begin() + static_cast<std::ptrdiff_t>(columns.first));
  }
}

bool has_column_of(const GroundTruth& truth, const ScoreLayout& layout, size_t anchor) {
  const auto& pairs = truth.pairs[anchor];
  const auto first = static_cast<int64_t>(layout.window_length - 1);
  return std::any_of(pairs.begin(), pairs.end(), [&](const GroundTruth::Pair& pair) {
    if (pair.label != PlaceLabel::same) return false;
    const ScoreLayout::Columns* columns = layout.columns_of(pair.sequence);
    return columns != nullptr &&
           pair.first - truth.tolerance_frames < first + static_cast<int64_t>(columns->count) &&
           pair.last() + truth.tolerance_frames >= first;
  });
}

FrameMatch match_of_column(const ScoreLayout& layout, size_t column) {
  assert(column < column_count(layout));
  const auto behind =
      std::ranges::upper_bound(layout.columns, column, {}, &ScoreLayout::Columns::first);
  const ScoreLayout::Columns& columns = *std::prev(behind);
  return {columns.sequence, layout.anchor(column - columns.first)};
}

}  // namespace vpr
