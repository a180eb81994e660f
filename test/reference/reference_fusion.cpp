#include "reference/reference_fusion.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "match/fusion.h"
#include "match/score_kernels.h"
#include "match/zscores.h"
#include "words/database.h"

namespace vpr {
namespace {

// w of each of the first `count` query frames.
std::vector<double> weights_of(const FrameDistances& scores, const FusionBasis& fusion,
                               size_t count, const Monitor& monitor) {
  std::vector<double> weights(count, 0);
  std::vector<uint16_t> row(scores.train_frames + kBlockFrames);
  FusionState agreement;
  BestFrames best;
  for (uint32_t j = 0; j < count; ++j) {
    check_stop(monitor);
    agreement.count(best, fusion.sequences);
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

ReferenceFusion::ReferenceFusion(std::span<const DescribedFrames> train,
                                 const DescribedFrames& query, const ScoreBasis& basis,
                                 std::span<const Cell> cells, size_t window_length,
                                 const Monitor& monitor) {
  const FusionBasis& fusion = basis.fusion;
  if (fusion.evidence == nullptr || cells.empty()) return;
  size_t first = 0;
  for (size_t s = 0; s < fusion.sequences.size(); ++s) {
    first_frame_[s] = first;
    first += fusion.sequences[s].frames;
  }
  for (const Cell& cell : cells)
    for (size_t k = 0; k < window_length; ++k) by_frame_[cell.query_window + k];
  const std::vector<double> weights = weights_of(zscores(frame_distances(train, query), basis),
                                                 fusion, by_frame_.rbegin()->first + 1, monitor);
  std::vector<std::pair<size_t, FusionRow*>> rows;
  for (auto& [frame, row] : by_frame_) rows.emplace_back(frame, &row);
  parallel_for(rows.size(), monitor, [&](size_t r) {
    const size_t frame = rows[r].first;
    *rows[r].second = reference_fusion_row(fusion, query.words[frame], weights[frame]);
  });
}

double ReferenceFusion::operator()(double z, size_t sequence, size_t i, size_t j) const {
  if (by_frame_.empty()) return z;
  constexpr double kLimit = static_cast<double>(kScoreBias) / kScoreUnit;
  const FusionRow& row = by_frame_.at(j);
  return std::clamp((z + row.added[first_frame_.at(sequence) + i]) * row.scale, -kLimit,
                    kLimit - 1.0 / kScoreUnit);
}

double fusion_tolerance(const FusionBasis& basis) {
  // Likelihoods have an error of 0.6, the largest has the same, and their mean a smaller one; a
  // score is rounded once more. The scale multiplies scores of up to 64 deviations: an error of 1.2
  // / 1024 nats changes it by at most half of that times the weight, which is at most 1.
  return basis.evidence == nullptr ? 0 : 0.5 + 2 + 64 * 1.2 / 2;
}

FusionRow reference_fusion_row(const FusionBasis& basis, const WordSet& words, double weight) {
  FusionRow row{std::vector<double>(basis.views.size(), 0), 1, std::nullopt};
  if (words.empty()) return row;
  const ViewEvidence& evidence = *basis.evidence;
  const ViewWords& views = evidence.of->fabmap.views;
  const std::vector<double> nats =
      fabmap1_log_likelihoods({evidence.model, views, evidence.index, words, views.views()});
  const auto is_known = [&](size_t i) { return basis.views[i] != FusedViews::kNoView; };
  for (size_t i = 0; i < row.added.size(); ++i)
    if (is_known(i) && (!row.likeliest || nats[basis.views[i]] > nats[basis.views[*row.likeliest]]))
      row.likeliest = i;
  if (!row.likeliest) return row;
  const double most = nats[basis.views[*row.likeliest]];
  const auto behind = [&](size_t i) { return std::max(nats[basis.views[i]] - most, -40.0); };
  double sum = 0;
  double count = 0;
  for (size_t i = 0; i < row.added.size(); ++i) {
    sum += is_known(i) ? behind(i) : 0;
    count += is_known(i) ? 1 : 0;
  }
  double squares = 0;
  for (size_t i = 0; i < row.added.size(); ++i) {
    if (is_known(i)) row.added[i] = -weight * (behind(i) - sum / count);
    squares += row.added[i] * row.added[i];
  }
  row.scale = 1 / std::sqrt(1 + squares / count);
  return row;
}

}  // namespace vpr
