#include "recognition/margin_scan.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <utility>

#include "recognition/row_outline.h"

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

}  // namespace vpr
