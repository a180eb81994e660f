#include "decide/exclusion_zones.h"

#include <algorithm>

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
  const size_t after = std::clamp(last, begin, end) - begin;
  uint32_t least = kNoCell;
  if (before > 0) least = kernels.minimum(piece.scores.data(), before);
  if (after < piece.scores.size())
    least =
        std::min(least, kernels.minimum(piece.scores.data() + after, piece.scores.size() - after));
  return least;
}

}  // namespace

ExclusionZones make_exclusion_zones(std::vector<uint32_t> radii,
                                    const std::vector<std::pair<size_t, size_t>>& overlapping) {
  const size_t sequences = radii.size();
  ExclusionZones zones{std::move(radii), {}};
  zones.shared.assign(sequences, std::vector<uint8_t>(sequences, 0));
  for (const auto& [a, b] : overlapping) zones.shared[a][b] = zones.shared[b][a] = 1;
  return zones;
}

size_t exclusion_radius(const DescribedFrames& sequence, const Monitor& monitor) {
  constexpr size_t kSampledFrames = 10'000;
  const size_t frames = sequence.rows.size();
  const double half = mean_distance_within(frame_distances({&sequence, 1}, sequence)) / 2;
  const std::vector<uint8_t> readable = readable_flags(readable_runs(sequence), frames);
  const size_t step = std::max<size_t>(1, frames / kSampledFrames);
  for (size_t apart = 1; apart < frames; ++apart) {
    check_stop(monitor);
    uint64_t sum = 0;
    uint64_t count = 0;
    for (size_t i = 0; i + apart < frames; i += step) {
      if (readable[i] == 0 || readable[i + apart] == 0) continue;
      sum += frame_distance(sequence.rows, i, i + apart);
      ++count;
    }
    if (count > 0 && static_cast<double>(sum) >= half * static_cast<double>(count)) return apart;
  }
  return std::max<size_t>(frames, 1);
}

MarginScan::MarginScan(ExclusionZones zones, size_t query_windows, const RowKernels& kernels)
    : zones_(std::move(zones)), kernels_(kernels), margins_(query_windows) {}

void MarginScan::operator()(std::span<const ScoreRow> row) {
  const Cell best = closest(row, kernels_);
  const size_t radius = zones_.widths[best.sequence];
  const size_t first = best.train_window - std::min<size_t>(best.train_window, radius);
  const size_t last = best.train_window + radius + 1;
  uint32_t runner_up = kNoCell;
  for (const ScoreRow& piece : row) {
    if (piece.sequence == best.sequence)
      runner_up = std::min(runner_up, smallest_outside(piece, first, last, kernels_));
    else if (zones_.shared[best.sequence][piece.sequence] == 0)
      runner_up = std::min(runner_up, smallest_outside(piece, 0, 0, kernels_));
  }
  if (runner_up != kNoCell) margins_[best.query_window] = runner_up - best.score;
}

}  // namespace vpr
