#include "evaluation/pair_curve.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "base/parallel.h"

namespace vpr {
namespace {

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

}  // namespace

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

}  // namespace vpr
