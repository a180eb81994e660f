// All pairs of a score matrix judged by the ground truth.
#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

#include "base/parallel.h"
#include "evaluate/judgment.h"

namespace vpr {
namespace {

struct ScoredColumn {
  uint64_t key = kNoScore;
  size_t column = 0;
};

struct ScanPart {
  std::vector<PlaceLabel> labels;  ///< of the current row
  bool skips_ignored = true;
  std::vector<ScoredColumn> ranked;
  PairJudgment pairs;  ///< without the curve
  size_t known_ranks = std::numeric_limits<size_t>::max();
  size_t unscored = 0;
  std::vector<uint64_t> same_keys;  ///< scores of pairs of the same place

  bool skips(size_t column) const { return skips_ignored && labels[column] == PlaceLabel::ignore; }
};

/// Better scores first, ties to the first column.
bool is_ahead(const ScoredColumn& a, const ScoredColumn& b) {
  return a.key < b.key || (a.key == b.key && a.column < b.column);
}

// Finds the correct ones among the kMaxRank best references.
void rank_correct_ones(QueryOutcome& query, ScanPart& part, std::span<const uint64_t> keys) {
  std::vector<ScoredColumn>& ranked = part.ranked;
  ranked.clear();
  for (size_t c = 0; c < keys.size(); ++c)
    if (keys[c] != kNoScore && !part.skips(c)) ranked.push_back({keys[c], c});
  const size_t count = std::min(ranked.size(), kMaxRank);
  std::partial_sort(ranked.begin(), ranked.begin() + static_cast<ptrdiff_t>(count), ranked.end(),
                    is_ahead);
  for (size_t rank = 1; rank <= count; ++rank)
    if (part.labels[ranked[rank - 1].column] == PlaceLabel::same)
      query.correct_ranks.push_back(static_cast<uint8_t>(rank));
}

void judge_row(QueryOutcome& query, ScanPart& part, std::span<const uint64_t> keys,
               const ScoreLayout& layout) {
  const auto& labels = part.labels;
  if (std::ranges::all_of(keys, [](uint64_t key) { return key == kNoScore; })) {
    ++part.unscored;
    return;
  }
  ScoredColumn best;
  ScoredColumn correct;
  std::optional<size_t> worst;
  size_t ranked = 0;
  for (size_t c = 0; c < keys.size(); ++c) {
    if (labels[c] == PlaceLabel::ignore) ++part.pairs.ignored;
    if (part.skips(c)) continue;
    const bool has_score = keys[c] != kNoScore;
    ranked += has_score ? 1 : 0;
    if (has_score && (!worst || keys[c] > keys[*worst])) worst = c;
    query.is_tied = (query.is_tied && keys[c] >= best.key) || (keys[c] == best.key && has_score);
    if (keys[c] < best.key) best = {keys[c], c};
    if (labels[c] != PlaceLabel::same) continue;
    if (has_score) part.same_keys.push_back(keys[c]);
    if (keys[c] < correct.key) correct = {keys[c], c};
  }
  if (correct.key != kNoScore) {
    query.rank = 1;
    for (size_t c = 0; c < keys.size(); ++c)
      *query.rank += is_ahead({keys[c], c}, correct) && !part.skips(c) ? 1 : 0;
  }
  query.key = best.key;
  rank_correct_ones(query, part, keys);
  if (best.key == kNoScore) return;  // only ignored ones have scores
  if (query.has_match && std::ranges::find(keys, kNoScore) != keys.end())
    part.known_ranks = std::min(part.known_ranks, ranked);
  part.pairs.worst_correct += labels[*worst] == PlaceLabel::same ? 1 : 0;
  query.best = match_of_column(layout, best.column);
  query.verdict = verdict_of(labels[best.column]);
}

constexpr size_t kBucketBits = 20;
constexpr size_t kMaxCounterBytes = size_t{128} << 20;  // of all workers

/// The distinct scores of pairs of the same place, found by their upper bits.
class KeyIndex {
 public:
  /// Reuses the memory of `sorted`.
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
  /// The index of the first key that is not smaller; size() if all are.
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
  std::vector<size_t> starts_;  // per bucket, the index of its first key; one more at the end
  size_t shift_ = 0;
};

struct KeyCount {
  uint64_t key = 0;
  uint64_t count = 0;
};

/// Numbers of incorrect pairs by score, relative to the keys of the index.
struct Counters {
  std::vector<uint64_t> before;  // between the previous key and this one; one more after the last
  std::vector<uint64_t> equal;
  KeyCount best{kNoScore, 0};
  KeyCount worst{0, 0};
  std::vector<PlaceLabel> labels;

  void add(uint64_t key, const KeyIndex& index) {
    if (key == kNoScore) return;
    const size_t at = index.lower_bound(key);
    ++(at < index.size() && index.key(at) == key ? equal : before)[at];
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
  const size_t workers = std::clamp<size_t>(kMaxCounterBytes / bytes, 1, thread_count());
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

// `same_keys` are sorted; `positives` pairs are of the same place.
Curve pair_curve(const ScoreMatrix& matrix, const GroundTruth& truth, const ScoreLayout& layout,
                 std::vector<uint64_t> same_keys, uint64_t positives, const Monitor& monitor) {
  const KeyIndex index(std::move(same_keys));
  const Counters counters = count_incorrect(matrix, truth, layout, index, monitor);
  Curve curve{matrix.kind, positives, {}};
  if (counters.best.count > 0 && (index.size() == 0 || counters.best.key < index.key(0)))
    curve.points.push_back({counters.best.key, 0, 0, counters.best.count});
  curve.points.reserve(index.size() + 2);
  CurvePoint last;
  for (size_t k = 0; k < index.size(); ++k) {
    const uint64_t before = last.incorrect + counters.before[k];
    last = {index.key(k), last.correct + index.count(k), before, before + counters.equal[k]};
    curve.points.push_back(last);
  }
  const uint64_t after = counters.before.back();
  if (after > 0 && (curve.points.empty() || curve.points.back().key < counters.worst.key)) {
    const uint64_t all = last.incorrect + after;
    curve.points.push_back({counters.worst.key, last.correct, all - counters.worst.count, all});
  }
  return curve;
}

}  // namespace

MatrixScan scan_matrix(const ScoreMatrix& matrix, const GroundTruth& truth,
                       const ScoreLayout& layout, const Monitor& monitor, bool skips_ignored) {
  MatrixScan scan;
  auto& [outcomes, pairs] = scan;
  outcomes = unanswered(truth, layout.scope.query.frames, layout.window_length, matrix.kind);
  outcomes.has_scores = matrix.has_scores;
  outcomes.has_ranks = true;
  const auto& sequences = layout.scope.sequences;
  for (QueryOutcome& query : outcomes.queries) {
    for (size_t s = 0; s < sequences.size(); ++s)
      for (const LabelStretch& run :
           label_runs(truth, query.frame, s, sequences[s].sequence.frames))
        if (run.label == PlaceLabel::same) query.correct_count += run.last - run.first + 1;
    pairs.curve.positives += query.correct_count;
  }
  std::vector<ScanPart> parts(thread_count());
  for (ScanPart& part : parts) part.skips_ignored = skips_ignored && truth.asked.empty();
  matrix.for_each_row(parts.size(), monitor, "reading scores",
                      [&](size_t worker, size_t row, std::span<const uint64_t> keys) {
                        label_row(truth, layout, row, parts[worker].labels);
                        judge_row(scan.outcomes.at_window(row), parts[worker], keys, layout);
                      });
  size_t count = 0;
  for (const ScanPart& part : parts) count += part.same_keys.size();
  std::vector<uint64_t> same_keys;
  same_keys.reserve(count);
  for (ScanPart& part : parts) {
    pairs.ignored += part.pairs.ignored;
    pairs.worst_correct += part.pairs.worst_correct;
    outcomes.known_ranks = std::min(outcomes.known_ranks, part.known_ranks);
    outcomes.unscored += part.unscored;
    same_keys.insert(same_keys.end(), part.same_keys.begin(), part.same_keys.end());
    part.same_keys = {};
  }
  pairs.same_without_score = pairs.curve.positives - same_keys.size();
  std::ranges::sort(same_keys);
  pairs.curve =
      pair_curve(matrix, truth, layout, std::move(same_keys), pairs.curve.positives, monitor);
  pairs.curve.has_scores = matrix.has_scores;
  if (!matrix.has_scores) pairs.curve.points.clear();
  return scan;
}

}  // namespace vpr
