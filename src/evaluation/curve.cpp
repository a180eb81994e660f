#include "evaluation/curve.h"

#include <algorithm>

namespace vpr {

void sort_items(std::vector<ScoredItem>& items) {
  std::sort(items.begin(), items.end(),
            [](const ScoredItem& a, const ScoredItem& b) { return a.key < b.key; });
}

Curve curve_of(std::span<const ScoredItem> items, uint64_t to_find, ScoreOrder kind) {
  Curve curve{kind, to_find, {}};
  CurvePoint last;  // what has been accepted so far
  bool is_kept = true;
  for (size_t i = 0; i < items.size() && items[i].key != kNoScore;) {
    CurvePoint point{items[i].key, last.correct, last.incorrect, last.incorrect};
    for (; i < items.size() && items[i].key == point.key; ++i)
      (items[i].is_correct ? point.correct : point.incorrect) += items[i].weight;
    if (point.correct == last.correct && point.incorrect == last.incorrect) continue;
    is_kept = curve.points.empty() || point.correct > last.correct;
    if (is_kept) curve.points.push_back(point);
    last = point;
  }
  if (!is_kept) curve.points.push_back(last);
  return curve;
}

}  // namespace vpr
