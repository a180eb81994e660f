#include "evaluate/matrix_scan.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "base/parallel.h"

namespace vpr {

namespace {

/// The best of some columns, ties to the first.
struct BestColumn {
  uint64_t key = kNoScore;
  size_t column = 0;
};

/// One worker's share.
struct ScanPart {
  std::vector<PlaceLabel> labels;
  std::vector<BestColumn> heap;
  MatrixScan scan;
};

/// Better scores first, ties to the first.
bool is_ahead(const BestColumn& a, const BestColumn& b) {
  return a.key < b.key || (a.key == b.key && a.column < b.column);
}

size_t rank_of(const BestColumn& correct, std::span<const uint64_t> keys,
               const std::vector<PlaceLabel>& labels) {
  size_t ahead = 0;
  for (size_t c = 0; c < keys.size(); ++c)
    ahead += is_ahead({keys[c], c}, correct) && labels[c] != PlaceLabel::ignore ? 1 : 0;
  return ahead + 1;
}

// Which of the kMostRanked best references are right. The heap's front is the worst that is kept.
void rank_right_ones(QueryOutcome& query, std::vector<BestColumn>& heap,
                     std::span<const uint64_t> keys, const std::vector<PlaceLabel>& labels) {
  heap.clear();
  for (size_t c = 0; c < keys.size(); ++c) {
    query.right_count += labels[c] == PlaceLabel::same ? 1 : 0;
    if (keys[c] == kNoScore || labels[c] == PlaceLabel::ignore) continue;
    if (heap.size() == kMostRanked) {
      if (keys[c] >= heap.front().key) continue;  // a tie comes behind
      std::pop_heap(heap.begin(), heap.end(), is_ahead);
      heap.pop_back();
    }
    heap.push_back({keys[c], c});
    std::push_heap(heap.begin(), heap.end(), is_ahead);
  }
  std::sort_heap(heap.begin(), heap.end(), is_ahead);
  for (size_t rank = 1; rank <= heap.size(); ++rank)
    if (labels[heap[rank - 1].column] == PlaceLabel::same)
      query.right_ranks.push_back(static_cast<uint8_t>(rank));
}

void count_pairs(ScanPart& share, std::span<const uint64_t> keys) {
  MatrixScan& scan = share.scan;
  for (size_t c = 0; c < keys.size(); ++c) {
    if (share.labels[c] == PlaceLabel::different) continue;
    if (share.labels[c] == PlaceLabel::ignore) {
      ++scan.ignored_pairs;
      continue;
    }
    ++scan.same_pairs;
    if (keys[c] == kNoScore)
      ++scan.same_without_score;
    else
      scan.same_keys.push_back(keys[c]);
  }
}

void judge(QueryOutcome& query, ScanPart& share, std::span<const uint64_t> keys,
           const ScoreLayout& layout) {
  if (std::ranges::all_of(keys, [](uint64_t key) { return key == kNoScore; })) {
    query.verdict = Verdict::unreadable;
    return;
  }
  count_pairs(share, keys);
  BestColumn best;
  BestColumn correct;
  std::optional<size_t> worst;
  for (size_t c = 0; c < keys.size(); ++c) {
    if (share.labels[c] == PlaceLabel::ignore) continue;
    if (keys[c] != kNoScore && (!worst || keys[c] > keys[*worst])) worst = c;
    query.is_tied =
        (query.is_tied && keys[c] >= best.key) || (keys[c] == best.key && keys[c] != kNoScore);
    if (keys[c] < best.key) best = {keys[c], c};
    if (share.labels[c] == PlaceLabel::same && keys[c] < correct.key) correct = {keys[c], c};
  }
  if (correct.key != kNoScore) query.rank = rank_of(correct, keys, share.labels);
  query.key = best.key;
  rank_right_ones(query, share.heap, keys, share.labels);
  if (best.key == kNoScore) return;
  share.scan.worst_correct += share.labels[*worst] == PlaceLabel::same ? 1 : 0;
  query.best = match_of_column(layout, best.column);
  if (share.labels[best.column] == PlaceLabel::same) query.verdict = Verdict::correct;
}

void merge(MatrixScan& scan, MatrixScan&& share) {
  scan.same_pairs += share.same_pairs;
  scan.ignored_pairs += share.ignored_pairs;
  scan.same_without_score += share.same_without_score;
  scan.worst_correct += share.worst_correct;
  scan.same_keys.insert(scan.same_keys.end(), share.same_keys.begin(), share.same_keys.end());
  share.same_keys = {};
}

constexpr size_t kBucketBits = 20;
constexpr size_t kMostCounterBytes = size_t{128} << 20;  // of all workers

/// The distinct keys of correct pairs, and where a key stands among them.
class KeyIndex {
 public:
  /// Keeps of `sorted` one of each, in its memory.
  explicit KeyIndex(std::vector<uint64_t> sorted) : keys_(std::move(sorted)) {
    size_t distinct = 0;
    for (size_t i = 0; i < keys_.size(); ++i) {
      if (i == 0 || keys_[i] != keys_[distinct - 1]) {
        keys_[distinct++] = keys_[i];
        counts_.push_back(0);
      }
      ++counts_.back();
    }
    keys_.resize(distinct);
    keys_.shrink_to_fit();
    if (keys_.empty()) return;
    const uint64_t range = keys_.back() - keys_.front();
    const auto bits = static_cast<size_t>(std::bit_width(range));
    shift_ = bits > kBucketBits ? bits - kBucketBits : 0;
    starts_.resize((range >> shift_) + 2);
    size_t k = 0;
    for (size_t bucket = 0; bucket < starts_.size(); ++bucket) {
      while (k < keys_.size() && (keys_[k] - keys_.front()) >> shift_ < bucket) ++k;
      starts_[bucket] = k;
    }
  }
  size_t size() const { return keys_.size(); }
  uint64_t key(size_t i) const { return keys_[i]; }
  uint64_t count(size_t i) const { return counts_[i]; }
  /// The first key that is not smaller; size() where all are.
  size_t lower_bound(uint64_t key) const {
    if (keys_.empty() || key > keys_.back()) return keys_.size();
    if (key <= keys_.front()) return 0;
    const size_t bucket = (key - keys_.front()) >> shift_;
    const auto begin = keys_.begin() + static_cast<ptrdiff_t>(starts_[bucket]);
    const auto end = keys_.begin() + static_cast<ptrdiff_t>(starts_[bucket + 1]);
    return static_cast<size_t>(std::lower_bound(begin, end, key) - keys_.begin());
  }

 private:
  std::vector<uint64_t> keys_;
  std::vector<uint32_t> counts_;
  std::vector<size_t> starts_;  // per bucket, its first key; one more at the end
  size_t shift_ = 0;
};

/// A key of incorrect pairs and how many have it.
struct KeyCount {
  uint64_t key = 0;
  uint64_t count = 0;
};

/// Incorrect pairs: how many lie in front of each key (behind the one before), and on it.
struct Counters {
  std::vector<uint64_t> before;  // one more than keys: behind the last
  std::vector<uint64_t> equal;
  KeyCount best{kNoScore, 0};
  KeyCount worst{0, 0};
  std::vector<PlaceLabel> labels;

  void add(uint64_t key, const KeyIndex& index) {
    if (key == kNoScore) return;
    const size_t at = index.lower_bound(key);
    if (at < index.size() && index.key(at) == key)
      ++equal[at];
    else
      ++before[at];
    if (key < best.key) best = {key, 0};
    if (key == best.key) ++best.count;
    if (key > worst.key) worst = {key, 0};
    if (key == worst.key) ++worst.count;
  }
  void merge(const Counters& other) {
    for (size_t i = 0; i < before.size(); ++i) before[i] += other.before[i];
    for (size_t i = 0; i < equal.size(); ++i) equal[i] += other.equal[i];
    const auto take = [](KeyCount& mine, const KeyCount& theirs, bool is_beyond) {
      if (is_beyond) mine = {theirs.key, 0};
      if (mine.key == theirs.key) mine.count += theirs.count;
    };
    take(best, other.best, other.best.key < best.key);
    take(worst, other.worst, other.worst.key > worst.key);
  }
};

Counters count_incorrect(const ScoreMatrix& matrix, const GroundTruth& truth,
                         const ScoreLayout& layout, const KeyIndex& index, const Monitor& monitor) {
  const size_t bytes = 16 * (index.size() + 1);
  const size_t workers = std::clamp<size_t>(kMostCounterBytes / bytes, 1, thread_count());
  std::vector<Counters> counters(workers);
  for (Counters& each : counters) {
    each.before.resize(index.size() + 1);
    each.equal.resize(index.size());
  }
  matrix.for_each_row(workers, monitor, "counting pairs",
                      [&](size_t worker, size_t row, std::span<const uint64_t> keys) {
                        Counters& mine = counters[worker];
                        label_row(truth, layout, row, mine.labels);
                        for (size_t c = 0; c < keys.size(); ++c)
                          if (mine.labels[c] == PlaceLabel::different) mine.add(keys[c], index);
                      });
  for (size_t w = 1; w < workers; ++w) counters.front().merge(counters[w]);
  return std::move(counters.front());
}

// Whether frames are labeled same or ignore, or at most `width` before or behind one that is.
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

MatrixScan scan_matrix(const ScoreMatrix& matrix, const GroundTruth& truth,
                       const ScoreLayout& layout, const Monitor& monitor) {
  MatrixScan scan;
  Outcomes& outcomes = scan.outcomes;
  outcomes = {matrix.kind(), layout.scope.query.frames, layout.window_length, true, {}};
  outcomes.queries.resize(matrix.queries());
  std::vector<ScanPart> shares(thread_count());
  matrix.for_each_row(shares.size(), monitor, "reading scores",
                      [&](size_t worker, size_t row, std::span<const uint64_t> keys) {
                        ScanPart& share = shares[worker];
                        QueryOutcome& query = outcomes.queries[row];
                        query.frame = layout.anchor(row);
                        look_up_match(query, truth, layout);
                        label_row(truth, layout, row, share.labels);
                        judge(query, share, keys, layout);
                      });
  size_t pairs = 0;
  for (const ScanPart& share : shares) pairs += share.scan.same_keys.size();
  scan.same_keys.reserve(pairs);
  for (ScanPart& share : shares) merge(scan, std::move(share.scan));
  std::sort(scan.same_keys.begin(), scan.same_keys.end());
  return scan;
}

Curve pair_curve(const ScoreMatrix& matrix, const GroundTruth& truth, const ScoreLayout& layout,
                 MatrixScan& scan, const Monitor& monitor) {
  const KeyIndex index(std::move(scan.same_keys));
  scan.same_keys = {};
  const Counters counters = count_incorrect(matrix, truth, layout, index, monitor);
  Curve curve{matrix.kind(), scan.same_pairs, {}};
  const bool has_incorrect = counters.best.count > 0;
  if (has_incorrect && (index.size() == 0 || counters.best.key < index.key(0)))
    curve.points.push_back({counters.best.key, 0, 0, counters.best.count});
  curve.points.reserve(index.size() + 2);
  CurvePoint last;
  for (size_t k = 0; k < index.size(); ++k) {
    const uint64_t before = last.incorrect + counters.before[k];
    last = {index.key(k), last.correct + index.count(k), before, before + counters.equal[k]};
    curve.points.push_back(last);
  }
  const uint64_t behind = counters.before.back();
  if (behind > 0 && (curve.points.empty() || curve.points.back().key < counters.worst.key)) {
    const uint64_t all = last.incorrect + behind;
    curve.points.push_back({counters.worst.key, last.correct, all - counters.worst.count, all});
  }
  return curve;
}

LabeledScan::LabeledScan(const GroundTruth& truth, Elsewhere elsewhere, size_t window_length,
                         size_t query_windows, const RowKernels& kernels)
    : truth_(truth),
      widths_(elsewhere.widths),
      window_length_(window_length),
      untrained_(std::move(elsewhere), query_windows, kernels) {}

void LabeledScan::operator()(std::span<const ScoreRow> row) {
  const size_t anchor = window_length_ - 1;
  std::vector<ScoreRow> untrained;
  for (const ScoreRow& piece : row) {
    const size_t count = piece.scores.size();
    const size_t width = widths_[piece.sequence];
    const size_t first = piece.train_window + anchor;
    std::vector<PlaceLabel> labels(first + count + width);
    truth_.label_row(piece.query_window + anchor, piece.sequence, labels);
    const std::vector<uint8_t> near = near_place(labels, width);
    for (size_t begin = 0; begin < count; ++begin) {
      if (near[first + begin] != 0) continue;
      size_t end = begin;
      while (end < count && near[first + end] == 0) ++end;
      untrained.push_back(part_of_row(piece, begin, end - begin));
      begin = end;
    }
  }
  if (!untrained.empty()) untrained_(untrained);
}

std::vector<std::optional<uint32_t>> LabeledScan::result() const {
  return untrained_.result().margins;
}

std::vector<BestPair> best_pairs(const ScoreMatrix& matrix, const ScoreLayout& layout, size_t most,
                                 const Monitor& monitor) {
  std::vector<std::vector<uint32_t>> columns(matrix.queries());
  matrix.for_each_row(
      thread_count(), monitor, "pairs", [&](size_t, size_t query, std::span<const uint64_t> keys) {
        std::vector<uint32_t> order(keys.size());
        std::iota(order.begin(), order.end(), uint32_t{0});
        const auto end = order.begin() + static_cast<ptrdiff_t>(std::min(most, order.size()));
        std::partial_sort(order.begin(), end, order.end(), [&](uint32_t a, uint32_t b) {
          return keys[a] != keys[b] ? keys[a] < keys[b] : a < b;
        });
        for (auto column = order.begin(); column != end && keys[*column] != kNoScore; ++column)
          columns[query].push_back(*column);
      });
  std::vector<BestPair> pairs;
  for (size_t query = 0; query < columns.size(); ++query)
    for (const uint32_t column : columns[query])
      pairs.push_back({layout.anchor(query), match_of_column(layout, column)});
  return pairs;
}

std::vector<BestPair> best_pairs(const Result& result) {
  std::vector<BestPair> pairs;
  const size_t length = result.window_length();
  for (const auto& best : result.best)
    if (best)
      pairs.push_back(
          {anchor_of(best->query, length), {best->target, anchor_of(best->train, length)}});
  return pairs;
}

}  // namespace vpr
