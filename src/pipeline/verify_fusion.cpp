#include "pipeline/verify_fusion.h"

#include <algorithm>

#include "base/parallel.h"
#include "database/fused_views.h"
#include "matching/score_kernels.h"
#include "matching/standardized_frames.h"

namespace vpr {
namespace {

// The scores of the first query frames before they are fused.
FrameDistances unfused(std::span<const DescriptorSpan> train, const DescriptorSpan& query,
                       const ScoreBasis& basis, const Monitor& monitor) {
  std::vector<uint8_t> keep(train.size(), 0);
  std::vector<DescriptorSpan> searched;
  for (const FusedWalk& walk : basis.fusion.walks) {
    keep[walk.sequence] = 1;
    searched.push_back(train[walk.sequence]);
  }
  ScoreBasis alone = basis;
  alone.fusion = {};
  return standardized(frame_distances(searched, query, train), basis_of(alone, train, keep),
                      monitor);
}

// w of each of the first `count` query frames.
std::vector<double> weights_of(const FrameDistances& scores, const FusionBasis& fusion,
                               size_t count, const Monitor& monitor) {
  std::vector<double> weights(count, 0);
  std::vector<uint16_t> row(scores.train_frames + kStretchFrames);
  Agreement agreement;
  BestFrames best;
  for (uint32_t j = 0; j < count; ++j) {
    check_stop(monitor);
    agreement.count(best, fusion.walks);
    weights[j] = fusion_weight(fusion, agreement);
    scores.start_row(j);
    scores.tile({&j, 1}, 0, scores.train_frames, row.data(), row.size());
    best = {fusion_row(fusion, scores.query.words[j], 0).likeliest, std::nullopt};
    for (size_t i = 0; i < scores.train_frames; ++i)
      if (fusion.views[i] != FusedViews::kNoView && (!best.closest || row[i] < row[*best.closest]))
        best.closest = i;
  }
  return weights;
}

}  // namespace

PlainFusion::PlainFusion(std::span<const DescriptorSpan> train, const DescriptorSpan& query,
                         const ScoreBasis& basis, std::span<const Cell> cells, size_t window_length,
                         const Monitor& monitor) {
  const FusionBasis& fusion = basis.fusion;
  if (fusion.evidence == nullptr || cells.empty()) return;
  size_t first = 0;
  for (const FusedWalk& walk : fusion.walks) {
    first_frame_[walk.sequence] = first;
    first += walk.frames;
  }
  for (const Cell& cell : cells)
    for (size_t k = 0; k < window_length; ++k) by_frame_[cell.query_window + k];
  const std::vector<double> weights = weights_of(unfused(train, query, basis, monitor), fusion,
                                                 by_frame_.rbegin()->first + 1, monitor);
  std::vector<std::pair<size_t, FusionRow*>> rows;
  for (auto& [frame, row] : by_frame_) rows.emplace_back(frame, &row);
  parallel_for(rows.size(), monitor, [&](size_t r) {
    const size_t frame = rows[r].first;
    *rows[r].second = plain_fusion_row(fusion, query.words[frame], weights[frame]);
  });
}

double PlainFusion::operator()(double z, size_t sequence, size_t i, size_t j) const {
  if (by_frame_.empty()) return z;
  constexpr double kLimit = static_cast<double>(kScoreBias) / kScoreUnit;
  const FusionRow& row = by_frame_.at(j);
  return std::clamp((z + row.added[first_frame_.at(sequence) + i]) * row.scale, -kLimit,
                    kLimit - 1.0 / kScoreUnit);
}

}  // namespace vpr
