#include "decide/margin_scan.h"

#include <algorithm>
#include <utility>

namespace vpr {
namespace {

// The best match of the row; ties to the first.
Cell closest(std::span<const ScoreRow> row, const RowKernels& kernels) {
  Cell best;
  best.score = kNoCell;
  for (const ScoreRow& piece : row) {
    const uint32_t least = kernels.minimum(piece.scores.data(), piece.scores.size());
    if (least >= best.score) continue;
    const size_t at = kernels.find_below(piece.scores.data(), 0, piece.scores.size(), least + 1);
    best = {static_cast<uint32_t>(piece.query_window), static_cast<uint32_t>(piece.sequence),
            static_cast<uint32_t>(piece.train_window + at), least};
  }
  return best;
}

// The smallest score of a piece outside windows [first, last).
uint32_t smallest_outside(const ScoreRow& piece, size_t first, size_t last,
                          const RowKernels& kernels) {
  const size_t begin = piece.train_window;
  const size_t end = begin + piece.scores.size();
  const size_t before = std::clamp(first, begin, end) - begin;
  const size_t behind = std::clamp(last, begin, end) - begin;
  uint32_t least = kNoCell;
  if (before > 0) least = kernels.minimum(piece.scores.data(), before);
  if (behind < piece.scores.size())
    least = std::min(least,
                     kernels.minimum(piece.scores.data() + behind, piece.scores.size() - behind));
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

MarginScan::MarginScan(Elsewhere elsewhere, size_t query_windows, const RowKernels& kernels)
    : elsewhere_(std::move(elsewhere)), kernels_(kernels) {
  result_.best.resize(query_windows);
  result_.margins.resize(query_windows);
}

void MarginScan::operator()(std::span<const ScoreRow> row) {
  const Cell best = closest(row, kernels_);
  const size_t width = elsewhere_.widths[best.sequence];
  const size_t first = best.train_window - std::min<size_t>(best.train_window, width);
  uint32_t elsewhere = kNoCell;
  for (const ScoreRow& piece : row) {
    if (piece.sequence == best.sequence)
      elsewhere = std::min(elsewhere,
                           smallest_outside(piece, first, best.train_window + width + 1, kernels_));
    else if (elsewhere_.shared[best.sequence][piece.sequence] == 0)
      elsewhere = std::min(elsewhere, smallest_outside(piece, 0, 0, kernels_));
  }
  result_.best[best.query_window] = best;
  if (elsewhere != kNoCell) result_.margins[best.query_window] = elsewhere - best.score;
}

}  // namespace vpr
