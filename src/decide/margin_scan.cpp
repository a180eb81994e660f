#include "decide/margin_scan.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <utility>

namespace vpr {

namespace {

constexpr size_t kLocks = 256;

/// What is known of one row: an outline of each sequence.
using RowOutlines = std::vector<RowOutline>;

RowOutline* find(RowOutlines& row, size_t sequence) {
  for (RowOutline& outline : row)
    if (outline.sequence == sequence) return &outline;
  return nullptr;
}

// Ties: the smallest sequence, and in it the first window.
const RowOutline* find_best(const RowOutlines& row) {
  const RowOutline* best = nullptr;
  for (const RowOutline& outline : row)
    if (best == nullptr || outline.best.score < best->best.score ||
        (outline.best.score == best->best.score && outline.sequence < best->sequence))
      best = &outline;
  return best;
}

// The smallest score in sequences that show another place than this one.
uint32_t smallest_of_others(const RowOutlines& row, size_t sequence, const Elsewhere& elsewhere) {
  uint32_t least = kNoCell;
  for (const RowOutline& outline : row)
    if (outline.sequence != sequence && elsewhere.shared[sequence][outline.sequence] == 0)
      least = std::min(least, outline.best.score);
  return least;
}

// The smallest score of the sequence that is not near `window`.
uint32_t smallest_elsewhere(const RowOutlines& row, size_t sequence, size_t window) {
  uint32_t least = kNoCell;
  for (const RowOutline& outline : row)
    if (outline.sequence == sequence) least = std::min(least, smallest_outside(outline, window));
  return least;
}

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

Elsewhere make_elsewhere(std::vector<uint32_t> widths,
                         const std::vector<std::pair<size_t, size_t>>& shared_places) {
  const size_t sequences = widths.size();
  Elsewhere elsewhere{std::move(widths), {}};
  elsewhere.shared.assign(sequences, std::vector<uint8_t>(sequences, 0));
  for (const auto& [a, b] : shared_places) elsewhere.shared[a][b] = elsewhere.shared[b][a] = 1;
  return elsewhere;
}

struct MarginScan::Rows {
  explicit Rows(size_t count) : outlines(count) {}
  std::vector<RowOutlines> outlines;  // per query window
  std::array<std::mutex, kLocks> locks;
};

MarginScan::MarginScan(Elsewhere elsewhere, size_t query_windows, const RowKernels& kernels)
    : elsewhere_(std::move(elsewhere)),
      kernels_(kernels),
      rows_(std::make_unique<Rows>(query_windows)) {}

MarginScan::~MarginScan() = default;

void MarginScan::operator()(const ScoreRow& row) {
  take(row, kernels_.minimum(row.scores.data(), row.scores.size()));
}

void MarginScan::take(const ScoreRow& row, uint32_t least) {
  const uint32_t* scores = row.scores.data();
  const size_t count = row.scores.size();
  const std::lock_guard lock(rows_->locks[row.query_window % kLocks]);
  RowOutlines& outlines = rows_->outlines[row.query_window];
  RowOutline* outline = find(outlines, row.sequence);
  if (outline != nullptr && least > outline->best.score && least >= outline->bound) {
    note_seen(*outline, row.train_window, row.train_window + count);
    return;
  }
  if (outline == nullptr) {
    outline = &outlines.emplace_back();
    outline->sequence = static_cast<uint32_t>(row.sequence);
    outline->width = elsewhere_.widths[row.sequence];
  }
  add_piece(*outline, row, least, kernels_.find_below(scores, 0, count, least + 1), kernels_);
}

MarginScanResult MarginScan::result() const {
  MarginScanResult result;
  for (size_t window = 0; window < rows_->outlines.size(); ++window) {
    const RowOutlines& row = rows_->outlines[window];
    auto& best = result.best.emplace_back();
    auto& margin = result.margins.emplace_back();
    const RowOutline* outline = find_best(row);
    if (outline == nullptr) continue;
    best = {static_cast<uint32_t>(window), outline->sequence, outline->best.window,
            outline->best.score};
    const uint32_t elsewhere =
        std::min(smallest_elsewhere(row, outline->sequence, outline->best.window),
                 smallest_of_others(row, outline->sequence, elsewhere_));
    if (elsewhere != kNoCell) margin = elsewhere - outline->best.score;
  }
  return result;
}

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
