#include "decide/automatic_margin.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "match/distance_statistics.h"
#include "match/match.h"
#include "match/zscores.h"

namespace vpr {
namespace {

/// Consecutive frames of a sequence that are matched as a query of their own.
struct Part {
  size_t first = 0;
  size_t count = 0;
  std::vector<size_t> unreadable;  ///< counted from `first`

  DescribedFrames of(const DescribedFrames& sequence) const {
    return {sequence.rows.subspan(first, count), unreadable, nullptr,
            sequence.words.empty() ? sequence.words : sequence.words.subspan(first, count)};
  }
};

Part make_part(const DescribedFrames& sequence, size_t first, size_t count) {
  Part part{first, count, {}};
  for (const size_t frame : sequence.unreadable)
    if (frame >= first && frame < first + count) part.unreadable.push_back(frame - first);
  return part;
}

// The whole sequence, or, if it has more than most_pairs frame pairs with `other_frames`, at least
// two evenly spread parts of 1000 frames or two windows. The first part begins with the sequence,
// and the last one ends with it.
std::vector<Part> choose_parts(const DescribedFrames& sequence, size_t other_frames,
                               size_t window_length, size_t most_pairs) {
  constexpr size_t kPartFrames = 1000;
  const size_t frames = sequence.rows.size();
  const size_t length = std::max(kPartFrames, 2 * window_length);
  if (length >= frames || frames <= most_pairs / other_frames)
    return {make_part(sequence, 0, frames)};
  const size_t count = std::max<size_t>(2, most_pairs / other_frames / length);
  std::vector<Part> parts;
  for (size_t p = 0; p < count; ++p)
    parts.push_back(make_part(sequence, p * (frames - length) / (count - 1), length));
  return parts;
}

size_t windows_of(size_t frames, size_t window_length) {
  return frames < window_length ? 0 : frames - window_length + 1;
}

/// Query windows with best matches, and those of them whose matches advance like the query.
struct WindowCounts {
  size_t all = 0;
  size_t consistent = 0;
};

void count_consistent(WindowCounts& counts, const MarginScanResult& scan, size_t length) {
  constexpr double kLeastMargin = 3;  // standard deviations of a mean of independent frames
  const size_t apart = length / 2;
  const double least =
      kLeastMargin * kScoreUnit * std::sqrt(static_cast<double>(length));  // as a sum
  const auto is_clear = [&](size_t window) {
    return scan.margins[window] && *scan.margins[window] >= least;
  };
  for (size_t window = apart; window < scan.best.size(); ++window) {
    if (!scan.best[window] || !scan.best[window - apart]) continue;
    ++counts.all;
    const size_t from = scan.best[window - apart]->train_window;
    const size_t to = scan.best[window]->train_window;
    const bool follows = to >= from + (apart + 1) / 2 && to <= from + apart + apart / 2;
    if (follows && is_clear(window) && is_clear(window - apart)) ++counts.consistent;
  }
}

bool is_seen_in(const DescribedFrames& query, const DescribedFrames& train,
                const ExclusionZones& zone, const ScoreBasis& basis, const RowKernels& kernels,
                const Monitor& monitor, size_t most_pairs) {
  constexpr size_t kWindow = 20;
  constexpr size_t kShortestWindow = 4;
  constexpr size_t kFewest = 10;  // one window in ten
  const size_t length = std::min(kWindow, std::min(query.rows.size(), train.rows.size()) / 2);
  if (length < kShortestWindow) return false;
  WindowCounts counts;
  const FrameDistances distances = frame_distances({&train, 1}, {query.rows.first(0), {}});
  for (const Part& part : choose_parts(query, train.rows.size(), length, most_pairs)) {
    MarginScan scan(zone, part.count - length + 1, kernels);
    match(zscores(distances.of_query(part.of(query)), basis, monitor),
          {length, kDefaultMemoryLimit, kernels}, {{}, {std::ref(scan)}}, monitor);
    count_consistent(counts, scan.result(), length);
  }
  return counts.consistent > 0 && kFewest * counts.consistent >= counts.all;
}

FrameDistances scored(FrameDistances distances, const std::optional<ScoreBasis>& basis,
                      const Monitor& monitor) {
  return basis ? zscores(std::move(distances), *basis, monitor) : distances;
}

std::optional<ScoreBasis> basis_of_kept(const ScoreBasis* basis,
                                        std::span<const DescribedFrames> sequences,
                                        const std::vector<uint8_t>& keep) {
  return basis == nullptr ? std::nullopt : std::optional(basis_of(*basis, sequences, keep));
}

// The pieces of a row at least `gap` windows before or after the query window. The query is a part
// of the training sequence that begins with its frame `first`.
std::vector<ScoreRow> far_pieces(std::span<const ScoreRow> row, size_t first, size_t gap) {
  std::vector<ScoreRow> pieces;
  for (ScoreRow piece : row) {
    piece.query_window += first;
    const size_t begin = piece.train_window;
    const size_t end = begin + piece.scores.size();
    const size_t before = piece.query_window + 1 > gap ? piece.query_window + 1 - gap : 0;
    const size_t to = std::clamp(before, begin, end);
    const size_t from = std::clamp(piece.query_window + gap, begin, end);
    if (to > begin) pieces.push_back(part_of_row(piece, 0, to - begin));
    if (from < end) pieces.push_back(part_of_row(piece, from - begin, end - from));
  }
  return pieces;
}

// The mean frame distance of two windows of one sequence.
double mean_frame_distance(const DescribedFrames& sequence, size_t a, size_t b,
                           size_t window_length) {
  uint64_t sum = 0;
  for (size_t k = 0; k < window_length; ++k) sum += frame_distance(sequence.rows, a + k, b + k);
  return static_cast<double>(sum) / static_cast<double>(window_length);
}

void add_own(std::vector<uint32_t>& margins, const DescribedFrames& sequence, uint32_t radius,
             const std::optional<ScoreBasis>& basis, const MatchSettings& settings,
             const Monitor& monitor, size_t most_pairs) {
  const size_t length = settings.window_length;
  const size_t frames = sequence.rows.size();
  const size_t windows = windows_of(frames, length);
  const size_t gap = exclusion_radius(sequence, monitor) + length;
  if (gap >= windows) return;
  MarginScan scan(make_exclusion_zones({radius}, {}), windows, settings.kernels);
  const FrameDistances own = frame_distances({&sequence, 1}, {sequence.rows.first(0), {}});
  for (const Part& part : choose_parts(sequence, frames, length, most_pairs)) {
    const auto take_row = [&](std::span<const ScoreRow> row) {
      const std::vector<ScoreRow> far = far_pieces(row, part.first, gap);
      if (!far.empty()) scan(far);
    };
    match(scored(own.of_query(part.of(sequence)), basis, monitor), settings, {{}, {take_row}},
          monitor);
  }
  const MarginScanResult& found = scan.result();
  const double mean = mean_distance_within(frame_distances({&sequence, 1}, sequence));
  for (size_t window = 0; window < windows; ++window) {
    if (!found.margins[window]) continue;
    const double distance =
        mean_frame_distance(sequence, window, found.best[window]->train_window, length);
    if (!is_same_place(distance, mean, length, kOwnDepth))
      margins.push_back(*found.margins[window]);
  }
}

void add_others(std::vector<uint32_t>& margins, std::span<const DescribedFrames> sequences,
                size_t own, const ExclusionZones& zones, const ScoreBasis* basis,
                const MatchSettings& settings, const Monitor& monitor, size_t most_pairs) {
  std::vector<DescribedFrames> others(sequences.begin(), sequences.end());
  std::vector<uint8_t> keep(sequences.size(), 1);
  for (size_t s = 0; s < sequences.size(); ++s)
    if (s == own || zones.shared[own][s] != 0) {
      others[s] = {sequences[s].rows.first(0), {}};
      keep[s] = 0;
    }
  const DescribedFrames& query = sequences[own];
  const size_t frames = count_frames(others);
  if (frames == 0 || query.rows.size() < settings.window_length) return;
  const FrameDistances distances = frame_distances(others, {query.rows.first(0), {}});
  const std::optional<ScoreBasis> own_basis = basis_of_kept(basis, sequences, keep);
  for (const Part& part : choose_parts(query, frames, settings.window_length, most_pairs)) {
    MarginScan scan(zones, windows_of(part.count, settings.window_length), settings.kernels);
    match(scored(distances.of_query(part.of(query)), own_basis, monitor), settings,
          {{}, {std::ref(scan)}}, monitor);
    for (const auto& margin : scan.result().margins)
      if (margin) margins.push_back(*margin);
  }
}

// The largest plausible margin. The largest of n exponential values is above mean (ln n + 4) once
// in e^4 cases.
uint32_t largest_likely(std::span<const uint32_t> false_margins, uint64_t mean) {
  const double most =
      static_cast<double>(mean) * (std::log(static_cast<double>(false_margins.size())) + 4);
  const auto likely = std::find_if(false_margins.begin(), false_margins.end(),
                                   [&](uint32_t margin) { return margin <= most; });
  return likely == false_margins.end() ? 0 : *likely;
}

}  // namespace

std::vector<std::pair<size_t, size_t>> find_overlapping_sequences(
    std::span<const DescribedFrames> sequences, const std::vector<uint32_t>& radii,
    const RowKernels& kernels, const Monitor& monitor, size_t most_pairs) {
  const size_t count = sequences.size();
  if (count < 2) return {};
  most_pairs /= count * (count - 1);
  StatisticsSettings settings;
  settings.samples = 1000;
  std::vector<std::vector<uint8_t>> seen(count, std::vector<uint8_t>(count, 0));
  for (size_t b = 0; b < count; ++b) {
    const ExclusionZones zone = make_exclusion_zones({radii[b]}, {});
    const ScoreBasis basis =
        make_score_basis({}, true, compute_statistics(sequences.subspan(b, 1), settings, monitor));
    for (size_t a = 0; a < count; ++a)
      seen[a][b] = a != b && is_seen_in(sequences[a], sequences[b], zone, basis, kernels, monitor,
                                        most_pairs);
  }
  std::vector<std::pair<size_t, size_t>> pairs;
  for (size_t a = 0; a < count; ++a)
    for (size_t b = a + 1; b < count; ++b)
      if (seen[a][b] != 0 || seen[b][a] != 0) pairs.emplace_back(a, b);
  return pairs;
}

std::vector<uint32_t> false_margins(std::span<const DescribedFrames> sequences,
                                    const ExclusionZones& zones, const ScoreBasis* basis,
                                    const MatchSettings& settings, const Monitor& monitor,
                                    size_t most_pairs) {
  std::vector<uint32_t> margins;
  for (size_t s = 0; s < sequences.size(); ++s) {
    const Monitor part = part_of(monitor, "training", s, sequences.size());
    std::vector<uint8_t> keep(sequences.size(), 0);
    keep[s] = 1;
    add_own(margins, sequences[s], zones.widths[s], basis_of_kept(basis, sequences, keep), settings,
            part, most_pairs);
    add_others(margins, sequences, s, zones, basis, settings, part, most_pairs);
  }
  std::sort(margins.begin(), margins.end(), std::greater<>());
  return margins;
}

double automatic_margin(std::span<const uint32_t> false_margins, const ScoreKind& score,
                        double typical_distance, size_t window_length) {
  const double least = score.least_margin(typical_distance, window_length);
  if (false_margins.empty()) return least;
  const uint64_t sum = std::accumulate(false_margins.begin(), false_margins.end(), uint64_t{0});
  const uint64_t mean = sum / false_margins.size();
  const uint64_t above = largest_likely(false_margins, mean) + mean + 1;
  return std::max(least, score.frame_value(static_cast<double>(above), window_length));
}

bool is_same_place(double frame_distance, double mean_distance, size_t window_length,
                   double depth) {
  return frame_distance <
         (1 - depth / std::sqrt(static_cast<double>(window_length))) * mean_distance;
}

}  // namespace vpr
