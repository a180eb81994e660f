#include "pipeline/verify_fusion.h"

#include <algorithm>

#include "base/parallel.h"
#include "matching/score_kernels.h"

namespace vpr {

PlainFusion::PlainFusion(const FusionBasis& basis, std::span<const Cell> cells,
                         size_t window_length, std::span<const WordSet> words,
                         const Monitor& monitor) {
  if (basis.evidence == nullptr) return;
  size_t first = 0;
  for (const FusedWalk& walk : basis.walks) {
    first_frame_[walk.sequence] = first;
    first += walk.frames;
  }
  for (const Cell& cell : cells)
    for (size_t k = 0; k < window_length; ++k) by_frame_[cell.query_window + k];
  std::vector<std::pair<size_t, std::vector<double>*>> rows;
  for (auto& [frame, row] : by_frame_) rows.emplace_back(frame, &row);
  parallel_for(rows.size(), monitor,
               [&](size_t r) { *rows[r].second = plain_fusion_row(basis, words[rows[r].first]); });
}

double PlainFusion::operator()(double z, size_t sequence, size_t i, size_t j) const {
  if (by_frame_.empty()) return z;
  constexpr double kLimit = static_cast<double>(kScoreBias) / kScoreUnit;
  return std::clamp(z - by_frame_.at(j)[first_frame_.at(sequence) + i], -kLimit,
                    kLimit - 1.0 / kScoreUnit);
}

}  // namespace vpr
