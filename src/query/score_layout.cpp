#include "query/score_layout.h"

#include <algorithm>
#include <cassert>
#include <iterator>

namespace vpr {

const ScoreLayout::Columns* ScoreLayout::columns_of(uint32_t sequence) const {
  const auto found = std::ranges::lower_bound(columns, sequence, {}, &Columns::sequence);
  return found != columns.end() && found->sequence == sequence ? &*found : nullptr;
}

GroundTruthScope scope_of(const Result& result) {
  GroundTruthScope scope;
  scope.query = result.query;
  if (result.places) scope.places = result.places->names;
  scope.has_places = result.places && result.places->names.size() != result.places->views;
  for (const ComparedSequence& compared : result.sequences)
    scope.sequences.push_back({compared.sequence, compared.searched});
  return scope;
}

size_t window_count(size_t frames, size_t window_length) {
  return frames < window_length ? 0 : frames - window_length + 1;
}

size_t row_count(const ScoreLayout& layout) {
  return window_count(layout.scope.query.frames, layout.window_length);
}

size_t column_count(const ScoreLayout& layout) {
  return layout.columns.empty() ? 0 : layout.columns.back().first + layout.columns.back().count;
}

ScoreLayout layout_of(const Result& result) {
  ScoreLayout layout;
  layout.window_length = result.window_length();
  layout.scope = scope_of(result);
  for (size_t t = 0; t < result.sequences.size(); ++t) {
    const size_t windows = window_count(result.sequences[t].sequence.frames, layout.window_length);
    if (result.sequences[t].searched && windows > 0)
      layout.columns.push_back({static_cast<uint32_t>(t), column_count(layout), windows});
  }
  return layout;
}

MatchedFrame anchors_of(const Match& match, size_t window_length) {
  return {anchor_of(match.query, window_length),
          {match.sequence, anchor_of(match.train, window_length)}};
}

FrameMatch match_of_column(const ScoreLayout& layout, size_t column) {
  assert(column < column_count(layout));
  const auto after =
      std::ranges::upper_bound(layout.columns, column, {}, &ScoreLayout::Columns::first);
  const ScoreLayout::Columns& columns = *std::prev(after);
  return {columns.sequence, layout.anchor(column - columns.first)};
}

}  // namespace vpr
