#include "recognition/automatic_score.h"

#include <algorithm>
#include <cmath>

#include "base/step_parts.h"
#include "matching/fastable_batch.h"
#include "matching/standardized_frames.h"
#include "recognition/elsewhere.h"

namespace vpr {
namespace {

// Scores of c_l independent frames would spread by 1 / sqrt(c_l) deviations.
constexpr double kSpread = 5.5;

// One sequence as the query, against all others.
void compare_with_others(std::span<const DescriptorSpan> sequences, size_t own,
                         const ScoreBasis& basis, const MatchSettings& settings,
                         const Monitor& monitor, ClosestTable& table) {
  std::vector<DescriptorSpan> others(sequences.begin(), sequences.end());
  std::vector<uint8_t> keep(sequences.size(), 1);
  others[own] = {};
  keep[own] = 0;
  const FrameDistances others_scored = standardized(frame_distances(others, sequences[own]),
                                                    basis_of(basis, sequences, keep), monitor);
  const RowKernels& kernels = settings.kernels;
  match_fastable(others_scored, settings, monitor, [&](const DistanceRow& row) {
    const uint32_t* scores = row.distances.data();
    const size_t count = row.distances.size();
    const uint32_t least = kernels.minimum(scores, count);
    const size_t first = kernels.find_below(scores, 0, count, least + 1);
    keep_closer(table[row.sequence], {least, row.train_window + first, own, row.query_window});
  });
}

std::optional<ClosestWindows> closest_of_own(const DescriptorSpan& walk, const ScoreBasis& basis,
                                             const MatchSettings& settings,
                                             const Monitor& monitor) {
  return closest_elsewhere(
      walk, settings.window_length, settings.kernels,
      [&](const FrameDistances& distances, const RowConsumer& consume) {
        match_fastable(standardized(distances, basis, monitor), settings, monitor, consume);
      },
      monitor);
}

}  // namespace

ClosestTable find_closest_scores(std::span<const DescriptorSpan> sequences, const ScoreBasis& basis,
                                 const MatchSettings& settings, const Monitor& monitor) {
  if (sequences.size() == 1) return {closest_of_own(sequences[0], basis, settings, monitor)};
  ClosestTable table(sequences.size());
  for (size_t own = 0; own < sequences.size(); ++own)
    compare_with_others(sequences, own, basis, settings,
                        part_of(monitor, "training", own, sequences.size()), table);
  return table;
}

double largest_score_threshold(size_t window_length) {
  return -kSpread / std::sqrt(static_cast<double>(window_length));
}

AutomaticThreshold automatic_score_threshold(const std::optional<ClosestWindows>& closest,
                                             size_t window_length, double margin) {
  const double most = largest_score_threshold(window_length);
  const double found = closest ? mean_z(closest->distance, window_length) : most;
  return {std::min(found, most) - margin, ThresholdScale::mean_z, !closest || most < found};
}

ScoreBasis basis_of(const ScoreBasis& all, std::span<const DescriptorSpan> sequences,
                    const std::vector<uint8_t>& keep) {
  ScoreBasis basis = all;
  basis.mean.clear();
  for (std::vector<int8_t>& loadings : basis.components.loadings) loadings.clear();
  ptrdiff_t first = 0;
  for (size_t s = 0; s < sequences.size(); ++s) {
    const auto end = first + static_cast<ptrdiff_t>(sequences[s].rows.size());
    if (keep[s] != 0) {
      basis.mean.insert(basis.mean.end(), all.mean.begin() + first, all.mean.begin() + end);
      for (size_t k = 0; k < kMostComponents; ++k) {
        const std::vector<int8_t>& from = all.components.loadings[k];
        std::vector<int8_t>& to = basis.components.loadings[k];
        to.insert(to.end(), from.begin() + first, from.begin() + end);
      }
    }
    first = end;
  }
  return basis;
}

}  // namespace vpr
