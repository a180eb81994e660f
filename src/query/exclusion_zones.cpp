#include "query/exclusion_zones.h"

#include <algorithm>
#include <functional>
#include <set>

#include "match/components.h"
#include "match/distance_statistics.h"
#include "match/row_kernels.h"
#include "match/zscores.h"
#include "query/scores.h"

namespace vpr {
namespace {

// The best match of the row; ties to the first.
Cell closest(std::span<const ScoreRow> row) {
  Cell best;
  best.score = kNoCell;
  for (const ScoreRow& piece : row) {
    const uint32_t least = minimum_of(piece.scores);
    if (least >= best.score) continue;
    const size_t at = find_below(piece.scores, 0, least + 1);
    best = {static_cast<uint32_t>(piece.query_window), static_cast<uint32_t>(piece.sequence),
            static_cast<uint32_t>(piece.train_window + at), least};
  }
  return best;
}

// The smallest score of a piece outside windows [first, last).
uint32_t smallest_outside(const ScoreRow& piece, size_t first, size_t last) {
  const size_t begin = piece.train_window;
  const size_t end = begin + piece.scores.size();
  const size_t before = std::clamp(first, begin, end) - begin;
  const size_t after = std::clamp(last, begin, end) - begin;
  uint32_t least = kNoCell;
  if (before > 0) least = minimum_of(piece.scores.first(before));
  if (after < piece.scores.size()) least = std::min(least, minimum_of(piece.scores.subspan(after)));
  return least;
}

/// Consecutive frames of a sequence.
struct Part {
  size_t first = 0;
  size_t count = 0;
};

// The whole sequence, or, if it has more than most_pairs frame pairs with `other_frames`, at least
// two evenly spread parts. The first part begins with the sequence, and the last one ends with it.
std::vector<Part> choose_parts(size_t frames, size_t other_frames, size_t most_pairs) {
  constexpr size_t kPartFrames = 1000;
  if (kPartFrames >= frames || frames <= most_pairs / other_frames) return {{0, frames}};
  const size_t count = std::max<size_t>(2, most_pairs / other_frames / kPartFrames);
  std::vector<Part> parts;
  for (size_t p = 0; p < count; ++p)
    parts.push_back({p * (frames - kPartFrames) / (count - 1), kPartFrames});
  return parts;
}

/// A training sequence with its z-scores and its exclusion zone.
struct Searched {
  DescribedFrames frames;
  FrameDistances distances;  // of a query without frames
  ScoreBasis basis;
  ExclusionZones zone;
};

Searched make_searched(const DescribedFrames& frames, uint32_t radius, const Monitor& monitor) {
  StatisticsSettings settings;
  settings.samples = 1000;
  TrainStatistics statistics = compute_statistics({&frames, 1}, settings, monitor);
  statistics.components = compute_components({&frames, 1}, statistics.typical_distance, monitor);
  const double start_weight = FilterSettings{}.start_weight;  // for short sequences
  return {frames, frame_distances({&frames, 1}, {frames.rows.first(0), {}}),
          make_score_basis(statistics, start_weight), make_exclusion_zones({radius}, {})};
}

bool is_recognized(const DescribedFrames& query, const Searched& train, const Monitor& monitor,
                   size_t most_pairs) {
  constexpr size_t kWindow = 20;
  constexpr size_t kShortestWindow = 4;
  constexpr size_t kOneIn = 10;  // windows
  const size_t length =
      std::min(kWindow, std::min(query.rows.size(), train.frames.rows.size()) / 2);
  if (length < kShortestWindow) return false;
  const ScoreKind& score = score_kind(Score::zscore);
  const double least = score.default_margin(train.basis.typical_distance, length);
  size_t windows = 0;
  size_t recognized = 0;
  for (const Part& part : choose_parts(query.rows.size(), train.frames.rows.size(), most_pairs)) {
    std::vector<size_t> unreadable;
    for (const size_t frame : query.unreadable)
      if (frame >= part.first && frame < part.first + part.count)
        unreadable.push_back(frame - part.first);
    const DescribedFrames frames{query.rows.subspan(part.first, part.count), unreadable};
    MarginScan scan(train.zone, part.count - length + 1);
    match(zscores(read_ahead(train.distances.of_query(frames)), train.basis),
          {length, kDefaultMemoryLimit}, {{}, {std::ref(scan)}}, monitor);
    for (const auto& margin : scan.result()) {
      windows += margin ? 1 : 0;
      recognized += margin && score.frame_value(*margin, length) >= least ? 1 : 0;
    }
  }
  return recognized > 0 && kOneIn * recognized >= windows;
}

// The mean distance of two frames; of every step-th frame if rows have to be computed for it.
double mean_distance(const DescribedFrames& sequence, size_t step) {
  const FrameDistances own = frame_distances({&sequence, 1}, sequence);
  if (own.row_total || step == 1) return mean_distance_within(own);
  const DescriptorRows& rows = sequence.rows;
  std::vector<size_t> unreadable;
  for (const size_t frame : sequence.unreadable)
    if (frame % step == 0) unreadable.push_back(frame / step);
  const DescribedFrames some{{rows.shape, rows.bytes, step * rows.stride}, unreadable};
  return mean_distance_within(frame_distances({&some, 1}, some));
}

}  // namespace

ExclusionZones make_exclusion_zones(std::vector<uint32_t> radii,
                                    const std::vector<std::pair<size_t, size_t>>& overlapping) {
  const size_t sequences = radii.size();
  ExclusionZones zones{std::move(radii), {}};
  zones.overlaps.assign(sequences, std::vector<uint8_t>(sequences, 0));
  for (const auto& [a, b] : overlapping) zones.overlaps[a][b] = zones.overlaps[b][a] = 1;
  return zones;
}

size_t exclusion_radius(const DescribedFrames& sequence, const Monitor& monitor) {
  constexpr size_t kSampledFrames = 10'000;
  const size_t frames = sequence.rows.size();
  const size_t step = std::max<size_t>(1, frames / kSampledFrames);
  const double half = mean_distance(sequence, step) / 2;
  const std::vector<uint8_t> readable = readable_flags(readable_runs(sequence), frames);
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

void MarginScan::operator()(std::span<const ScoreRow> row) {
  const Cell best = closest(row);
  const size_t radius = zones_.widths[best.sequence];
  const size_t first = best.train_window - std::min<size_t>(best.train_window, radius);
  const size_t last = best.train_window + radius + 1;
  uint32_t runner_up = kNoCell;
  for (const ScoreRow& piece : row) {
    if (piece.sequence == best.sequence)
      runner_up = std::min(runner_up, smallest_outside(piece, first, last));
    else if (zones_.overlaps[best.sequence][piece.sequence] == 0)
      runner_up = std::min(runner_up, smallest_outside(piece, 0, 0));
  }
  if (runner_up != kNoCell) margins_[best.query_window] = runner_up - best.score;
}

std::vector<std::pair<size_t, size_t>> find_overlapping_sequences(
    std::span<const DescribedFrames> sequences, const std::vector<uint32_t>& radii,
    const Monitor& monitor, size_t most_pairs) {
  const size_t count = sequences.size();
  if (count < 2) return {};
  most_pairs /= count * (count - 1);
  std::set<std::pair<size_t, size_t>> pairs;
  for (size_t b = 0; b < count; ++b) {
    const Searched train = make_searched(sequences[b], radii[b], monitor);
    for (size_t a = 0; a < count; ++a)
      if (a != b && is_recognized(sequences[a], train, monitor, most_pairs))
        pairs.insert(std::minmax(a, b));
  }
  return {pairs.begin(), pairs.end()};
}

}  // namespace vpr
