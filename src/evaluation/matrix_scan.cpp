#include "evaluation/matrix_scan.h"

#include <algorithm>

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

size_t rank_of(const BestColumn& correct, std::span<const uint64_t> keys,
               const std::vector<PlaceLabel>& labels) {
  size_t in_front = 0;
  for (size_t c = 0; c < keys.size(); ++c) {
    const bool is_ahead = keys[c] < correct.key || (keys[c] == correct.key && c < correct.column);
    in_front += is_ahead && labels[c] != PlaceLabel::ignore ? 1 : 0;
  }
  return in_front + 1;
}

/// Better scores first, ties to the first.
bool is_ahead(const BestColumn& a, const BestColumn& b) {
  return a.key < b.key || (a.key == b.key && a.column < b.column);
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
  const auto has_score = [](uint64_t key) { return key != kNoScore; };
  if (std::none_of(keys.begin(), keys.end(), has_score)) {
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
  share.scan.best_key = std::min(share.scan.best_key, best.key);
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
  scan.best_key = std::min(scan.best_key, share.best_key);
  scan.worst_correct += share.worst_correct;
  scan.same_keys.insert(scan.same_keys.end(), share.same_keys.begin(), share.same_keys.end());
  share.same_keys = {};
}

}  // namespace

MatrixScan scan_matrix(const ScoreMatrix& matrix, const GroundTruth& truth,
                       const ScoreLayout& layout, const Monitor& monitor) {
  MatrixScan scan;
  Outcomes& outcomes = scan.outcomes;
  outcomes = {matrix.kind(), layout.scope.query_frames, layout.window_length, true, {}};
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

}  // namespace vpr
