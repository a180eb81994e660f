#include "query/row_scan.h"

#include <tuple>
#include <utility>

#include <oneapi/tbb/enumerable_thread_specific.h>
#include <oneapi/tbb/parallel_sort.h>

#include "base/error.h"
#include "match/row_kernels.h"

namespace vpr {
namespace {

Cell cell_at(const ScoreRow& row, size_t x) {
  return {static_cast<uint32_t>(row.query_window), static_cast<uint32_t>(row.sequence),
          static_cast<uint32_t>(row.train_window + x), row.scores[x]};
}

// Whether cell a is a better match than cell b of the same row.
bool is_closer(const Cell& a, const Cell& b) {
  return std::tie(a.score, a.sequence, a.train_window) <
         std::tie(b.score, b.sequence, b.train_window);
}

bool by_position(const Cell& a, const Cell& b) {
  return std::tie(a.query_window, a.sequence, a.train_window) <
         std::tie(b.query_window, b.sequence, b.train_window);
}

}  // namespace

void MaximumScan::operator()(const ScoreRow& row) {
  const uint32_t found = maximum_of(row.scores);
  std::atomic<uint32_t>& most = maxima_[row.sequence];
  uint32_t known = most;
  while (known < found && !most.compare_exchange_weak(known, found)) {
  }
}

struct RecognitionScan::Threads {
  struct Local {
    std::vector<Cell> recognitions;
    std::vector<Cell> best;
  };
  oneapi::tbb::enumerable_thread_specific<Local> locals;
  std::atomic<size_t> recognition_count{0};
};

RecognitionScan::RecognitionScan(RecognitionScanSettings settings)
    : settings_(std::move(settings)), threads_(std::make_unique<Threads>()) {}

RecognitionScan::~RecognitionScan() = default;

void RecognitionScan::operator()(const ScoreRow& row) {
  Threads::Local& local = threads_->locals.local();
  if (local.best.empty()) {
    Cell none;
    none.score = kNoCell;
    local.best.assign(settings_.query_windows, none);
  }
  const uint32_t least = minimum_of(row.scores);
  Cell& best = local.best[row.query_window];
  if (least <= best.score) {
    const Cell candidate = cell_at(row, find_below(row.scores, 0, least + 1));
    if (best.score == kNoCell || is_closer(candidate, best)) best = candidate;
  }
  const uint32_t limit = settings_.limits[row.sequence];
  if (least >= limit) return;
  const size_t before = local.recognitions.size();
  for (size_t x = find_below(row.scores, 0, limit); x < row.scores.size();
       x = find_below(row.scores, x + 1, limit))
    local.recognitions.push_back(cell_at(row, x));
  const size_t added = local.recognitions.size() - before;
  if (threads_->recognition_count.fetch_add(added) + added > settings_.max_recognitions)
    throw Error(
        ErrorKind::usage,
        "more than {} recognitions do not fit --max-memory. Use a stricter --t-r, or more memory.",
        settings_.max_recognitions);
}

RecognitionScanResult RecognitionScan::result() {
  RecognitionScanResult result;
  result.best.resize(settings_.query_windows);
  result.recognitions.reserve(threads_->recognition_count);
  for (Threads::Local& local : threads_->locals) {
    result.recognitions.insert(result.recognitions.end(), local.recognitions.begin(),
                               local.recognitions.end());
    std::vector<Cell>().swap(local.recognitions);
    for (size_t j = 0; j < local.best.size(); ++j) {
      const Cell& candidate = local.best[j];
      if (candidate.score == kNoCell) continue;
      if (!result.best[j] || is_closer(candidate, *result.best[j])) result.best[j] = candidate;
    }
  }
  oneapi::tbb::parallel_sort(result.recognitions.begin(), result.recognitions.end(), by_position);
  return result;
}

}  // namespace vpr
