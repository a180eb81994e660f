#include "recognition/row_outline.h"

#include <algorithm>

namespace vpr {
namespace {

using Point = RowOutline::Point;

bool is_closer(const Point& a, const Point& b) {
  return a.score != b.score ? a.score < b.score : a.window < b.window;
}

Point point_at(const ScoreRow& row, size_t x) {
  return {static_cast<uint32_t>(row.train_window + x), row.scores[x]};
}

// The smallest of cells [from, to) of the piece, if there is one, at the end that is farther from
// the best: it is outside whatever window near the best is asked for.
void add_smallest(std::vector<Point>& points, const ScoreRow& row, size_t from, size_t to,
                  size_t end, const RowKernels& kernels) {
  if (from >= to) return;
  points.push_back({static_cast<uint32_t>(row.train_window + end),
                    kernels.minimum(row.scores.data() + from, to - from)});
}

// Whatever window near the best is asked for, windows outside of its +-width are all before one
// that lies up to 2 * width before the best, and all behind one up to 2 * width behind it. Kept is
// what is smaller than all before (behind) it.
void add_candidates(RowOutline& outline, const ScoreRow& row, const RowKernels& kernels) {
  const size_t begin = row.train_window;
  const size_t end = begin + row.scores.size();
  const size_t best = outline.best.window;
  const size_t reach = 2 * size_t{outline.width};
  std::vector<Point>& points = outline.points;

  const size_t near_left = std::clamp(best - std::min(best, reach), begin, end);
  add_smallest(points, row, 0, near_left - begin, 0, kernels);
  uint32_t least = near_left > begin ? points.back().score : kNoCell;
  for (size_t window = near_left; window < std::min(best, end); ++window) {
    const Point point = point_at(row, window - begin);
    if (point.score >= least) continue;
    least = point.score;
    points.push_back(point);
  }

  if (best >= begin && best < end) points.push_back(outline.best);

  const size_t near_right = std::clamp(best + reach + 1, begin, end);
  add_smallest(points, row, near_right - begin, end - begin, end - 1 - begin, kernels);
  least = near_right < end ? points.back().score : kNoCell;
  for (size_t window = near_right; window > std::max(best + 1, begin); --window) {
    const Point point = point_at(row, window - 1 - begin);
    if (point.score >= least) continue;
    least = point.score;
    points.push_back(point);
  }
}

/// For any window, the smallest point outside of its +-width; windows are asked for in rising
/// order.
class OutsidePoints {
 public:
  OutsidePoints(const std::vector<Point>& points, size_t width) : points_(points), width_(width) {
    const auto smaller = [&](size_t a, size_t b) {
      return points[b].score < points[a].score ? b : a;
    };
    for (size_t i = 0; i < points.size(); ++i)
      up_to_.push_back(i == 0 ? 0 : smaller(up_to_.back(), i));
    from_.resize(points.size());
    for (size_t i = points.size(); i-- > 0;)
      from_[i] = i + 1 == points.size() ? i : smaller(i, from_[i + 1]);
  }

  /// The index of the point; the number of points where there is none.
  size_t smallest(size_t window) {
    while (before_ < points_.size() && points_[before_].window + width_ < window) ++before_;
    while (behind_ < points_.size() && points_[behind_].window <= window + width_) ++behind_;
    const size_t none = points_.size();
    const size_t left = before_ > 0 ? up_to_[before_ - 1] : none;
    const size_t right = behind_ < none ? from_[behind_] : none;
    if (left == none || right == none) return std::min(left, right);
    return points_[right].score < points_[left].score ? right : left;
  }

 private:
  const std::vector<Point>& points_;
  size_t width_;
  std::vector<size_t> up_to_;
  std::vector<size_t> from_;
  size_t before_ = 0;
  size_t behind_ = 0;
};

// Keeps the points that matter for the best, and for windows near it that have not come.
void prune(RowOutline& outline) {
  std::vector<Point>& points = outline.points;
  std::sort(points.begin(), points.end(),
            [](const Point& a, const Point& b) { return a.window < b.window; });
  OutsidePoints outside(points, outline.width);
  std::vector<uint8_t> keep(points.size(), 0);
  outline.bound = 0;
  const auto ask = [&](size_t window) {
    const size_t smallest = outside.smallest(window);
    if (smallest < points.size()) keep[smallest] = 1;
    outline.bound =
        std::max(outline.bound, smallest < points.size() ? points[smallest].score : kNoCell);
  };
  const size_t best = outline.best.window;
  const size_t width = outline.width;
  for (size_t window = best - std::min(best, width); window < outline.first; ++window) ask(window);
  ask(best);
  for (size_t window = outline.last; window <= best + width; ++window) ask(window);
  size_t kept = 0;
  for (size_t i = 0; i < points.size(); ++i)
    if (keep[i] != 0 || points[i].window == best) points[kept++] = points[i];
  points.resize(kept);
}

}  // namespace

void note_seen(RowOutline& outline, size_t begin, size_t end) {
  if (begin == outline.last) outline.last = static_cast<uint32_t>(end);
  if (end == outline.first) outline.first = static_cast<uint32_t>(begin);
}

void add_piece(RowOutline& outline, const ScoreRow& row, uint32_t least, size_t at,
               const RowKernels& kernels) {
  const size_t begin = row.train_window;
  const size_t end = begin + row.scores.size();
  const Point candidate{static_cast<uint32_t>(begin + at), least};
  if (is_closer(candidate, outline.best)) {
    const RowOutline before = outline;
    outline.best = candidate;
    outline.first = static_cast<uint32_t>(begin);
    outline.last = static_cast<uint32_t>(end);
    if (!before.points.empty() && before.first == end) outline.last = before.last;
    if (!before.points.empty() && before.last == begin) outline.first = before.first;
  } else {
    note_seen(outline, begin, end);
  }
  add_candidates(outline, row, kernels);
  prune(outline);
}

uint32_t smallest_outside(const RowOutline& outline, size_t window) {
  const size_t index = OutsidePoints(outline.points, outline.width).smallest(window);
  return index < outline.points.size() ? outline.points[index].score : kNoCell;
}

}  // namespace vpr
