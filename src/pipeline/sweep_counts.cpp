#include "pipeline/sweep_counts.h"

#include <algorithm>

#include "base/parallel.h"

namespace vpr {
namespace {

// Windows that are drawn together.
size_t block_of(const Result& result) {
  constexpr size_t kFewestFrames = 8;  // about a second of walking
  const auto* fabmap = std::get_if<FabmapQuerySettings>(&result.settings);
  const size_t block =
      fabmap == nullptr ? result.window_length() : std::max<size_t>(fabmap->window, kFewestFrames);
  return std::min(block, result.query_windows);
}

template <class T>
void add_once(std::vector<T>& values, const T& value) {
  if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(value);
}

// The scale of t_r; none of a probability.
std::optional<ThresholdScale> threshold_scale(const Result& result) {
  const auto* settings = std::get_if<SequenceQuerySettings>(&result.settings);
  if (settings == nullptr || decision_kind(settings->decision).accepts != nullptr)
    return std::nullopt;
  return settings->distance_threshold ? scale_of(*settings) : ThresholdScale::bits;
}

// What is swept beside the window.
void name_threshold(Sweep& sweep, const QuerySettings& settings) {
  const auto* sequences = std::get_if<SequenceQuerySettings>(&settings);
  const auto* decision = sequences == nullptr ? nullptr : &decision_kind(sequences->decision);
  sweep.threshold_symbol = decision == nullptr ? sweep.score->threshold_symbol : decision->symbol;
  sweep.threshold_order = decision == nullptr ? sweep.score->order : decision->order;
}

std::vector<CellCounts> counted_cells(const Grid& grid,
                                      const std::function<Result(size_t cell)>& result_of,
                                      const GroundTruth& truth,
                                      const UntrainedWindows& untrained_of,
                                      const Monitor& monitor) {
  const size_t thresholds = grid.thresholds.size();
  std::vector<CellCounts> cells(grid.windows.size() * thresholds);
  StepCounter counter(monitor, "count", cells.size());
  parallel_for(cells.size(), monitor, [&](size_t c) {
    const Result result = result_of(c);
    cells[c] = {grid.windows[c / thresholds], grid.thresholds[c % thresholds],
                threshold_scale(result), count_recognitions(result, truth, monitor),
                untrained_of ? untrained_of(c) : std::nullopt};
    counter.add();
  });
  return cells;
}

}  // namespace

Grid grid_of(std::span<const CellCounts> cells) {
  Grid grid;
  for (const CellCounts& cell : cells) {
    add_once(grid.windows, cell.window);
    add_once(grid.thresholds, cell.threshold);
  }
  return grid;
}

Sweep count_cells(const Result& shape, const Grid& grid,
                  const std::function<Result(size_t cell)>& result_of, const GroundTruth& truth,
                  uint64_t seed, const Monitor& monitor, const UntrainedWindows& untrained_of) {
  Sweep sweep;
  sweep.query_name = shape.query_name;
  sweep.replay = shape.replay;
  sweep.score = &shape.score();
  name_threshold(sweep, shape.settings);
  sweep.protocol = truth.protocol;
  sweep.cells = counted_cells(grid, result_of, truth, untrained_of, monitor);
  sweep.recommendation = recommend(sweep.cells, sweep.threshold_order);
  if (!sweep.recommendation.cell) return sweep;
  const Result recommended = result_of(*sweep.recommendation.cell);
  sweep.recommended_settings = recommended.settings;
  sweep.intervals = count_intervals(recommended, truth, seed);
  return sweep;
}

SweepIntervals count_intervals(const Result& result, const GroundTruth& truth, uint64_t seed) {
  const size_t length = result.window_length();
  const size_t block = block_of(result);
  const auto interval = [&](const auto& matches, auto query_of, PlaceLabel wanted) {
    std::vector<double> counts(result.query_windows, 0);
    for (const auto& match : matches)
      if (label_of(truth, match, length) == wanted) counts[query_of(match)] += 1;
    return bootstrap_sum(counts, block, seed);
  };
  const auto of_hit = [](const Match& hit) { return hit.query; };
  const auto of_cluster = [](const Cluster& cluster) { return cluster.query_window; };
  SweepIntervals intervals{block, interval(result.hits, of_hit, PlaceLabel::same),
                           interval(result.hits, of_hit, PlaceLabel::different)};
  if (!result.clusters) return intervals;
  const std::vector<Cluster>& clusters = result.clusters->all;
  intervals.correct_places = interval(clusters, of_cluster, PlaceLabel::same);
  intervals.incorrect_places = interval(clusters, of_cluster, PlaceLabel::different);
  return intervals;
}

}  // namespace vpr
