#include "pipeline/sweep.h"

#include <algorithm>
#include <memory>
#include <set>
#include <string>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel.h"
#include "matching/fastable_batch.h"
#include "pipeline/query_steps.h"
#include "pipeline/score_basis.h"

namespace vpr {
namespace {

/// One window length: a planned result for each threshold, and what the passes find.
struct LengthSweep {
  std::vector<QueryPlan> planned;  // as many as thresholds
  std::unique_ptr<MaximumScan> maxima;
  std::unique_ptr<HitScan> hits;
  HitScanResult found;
};

std::vector<LengthSweep> plan_sweep(const SequenceDatabase& database, const DescriptorSet& query,
                                    const std::string& query_name,
                                    const SequenceQuerySettings& base, const Grid& grid,
                                    const QueryResources& resources, const Monitor& monitor) {
  if (grid.windows.empty() || grid.thresholds.empty())
    throw Error(ErrorKind::usage, "give at least one c_l and one t_r");
  if (!find_sequence_method(base.method).is_exact)
    throw Error(
        ErrorKind::usage,
        fmt::format("a sweep is exact; {} is not, leave it out of the settings", base.method));
  // Each sentence once: most are the same for every setting.
  std::set<std::string> said;
  Monitor once = monitor;
  once.warn = [&](const std::string& sentence) {
    if (said.insert(sentence).second) warn(monitor, sentence);
  };
  std::vector<LengthSweep> sweeps;
  for (const uint64_t length : grid.windows) {
    LengthSweep& sweep = sweeps.emplace_back();
    for (const auto& threshold : grid.thresholds) {
      SequenceQuerySettings settings = base;
      settings.window_length = length;
      settings.distance_threshold = threshold;
      sweep.planned.push_back(plan_query(database, query, query_name, settings, resources, once));
    }
  }
  return sweeps;
}

bool any_relative(const std::vector<LengthSweep>& sweeps) {
  return std::any_of(sweeps.front().planned.begin(), sweeps.front().planned.end(), needs_maxima);
}

// All lengths keep their hits at the same time: each may have its share of the memory.
QueryResources share_of(QueryResources resources, size_t lengths) {
  resources.memory_limit /= lengths;
  return resources;
}

// What is below either limit.
void widen(HitScanSettings& widest, const HitScanSettings& other, size_t sequence) {
  const bool is_by_window =
      !widest.window_limits[sequence].empty() || !other.window_limits[sequence].empty();
  std::vector<uint32_t> by_window;
  for (size_t window = 0; is_by_window && window < widest.query_windows; ++window)
    by_window.push_back(std::max(widest.limit(sequence, window), other.limit(sequence, window)));
  widest.window_limits[sequence] = std::move(by_window);
  widest.limits[sequence] = std::max(widest.limits[sequence], other.limits[sequence]);
}

// Hits below the largest limit of any threshold, sequence by sequence.
HitScanSettings widest_scan(const LengthSweep& sweep, const QueryResources& resources) {
  HitScanSettings widest = scan_settings(sweep.planned.front(), resources);
  for (const QueryPlan& plan : sweep.planned) {
    const HitScanSettings settings = scan_settings(plan, resources);
    for (size_t s = 0; s < widest.limits.size(); ++s) widen(widest, settings, s);
  }
  return widest;
}

// Of t_r as it was planned.
ThresholdScale scale_of(const QueryPlan& plan) {
  if (plan.settings.distance_threshold) return scale_of(plan.settings);
  for (const Target& sequence : plan.sequences)
    if (sequence.threshold) return sequence.scale;
  return score_kind(plan.settings.score).automatic_scale;
}

CellCounts count_cell(const LengthSweep& sweep, const QueryPlan& plan, const GroundTruth& truth,
                      const Monitor& monitor) {
  const HitScanSettings limits = scan_settings(plan, {});
  HitScanResult found{{}, sweep.found.best};
  for (const Cell& hit : sweep.found.hits)
    if (hit.distance < limits.limit(hit.sequence, hit.query_window)) found.hits.push_back(hit);
  Result result = make_result(plan, found);
  cluster(result, monitor);
  return {plan.settings.window_length, plan.settings.distance_threshold, scale_of(plan),
          count_recognitions(result, truth, monitor)};
}

void check_grid(const Grid& grid, const FabmapQuerySettings& base) {
  if (grid.windows.empty() || grid.thresholds.empty())
    throw Error(ErrorKind::usage, "give at least one c_w and one t_p");
  if (base.loop)
    throw Error(ErrorKind::usage, "a sweep has no loop mode; leave \"loop\" out of the settings");
  for (const uint64_t window : grid.windows)
    for (const auto& threshold : grid.thresholds) {
      if (!threshold) throw Error(ErrorKind::usage, "t_p is a number, and never automatic");
      FabmapQuerySettings settings = base;
      settings.window = window;
      settings.place_threshold = *threshold;
      check_query_settings(settings);
    }
}

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

}  // namespace

Grid grid_of(std::span<const CellCounts> cells) {
  Grid grid;
  for (const CellCounts& cell : cells) {
    add_once(grid.windows, cell.window);
    add_once(grid.thresholds, cell.threshold);
  }
  return grid;
}

std::vector<CellCounts> sweep_sequences(const SequenceDatabase& database,
                                        const DescriptorSet& query, const std::string& query_name,
                                        const SequenceQuerySettings& base, const Grid& grid,
                                        const TruthReader& read_truth,
                                        const QueryResources& resources, const Monitor& monitor) {
  std::vector<LengthSweep> sweeps =
      plan_sweep(database, query, query_name, base, grid, resources, monitor);
  const GroundTruth truth = read_truth(scope_of(make_result(sweeps.front().planned.front())));
  const FrameDistances distances =
      searched_distances(database, sweeps.front().planned.front(), query);
  const std::vector<size_t> lengths(grid.windows.begin(), grid.windows.end());
  const MatchSettings match{1, resources.memory_limit, resources.kernels};
  const auto match_lengths = [&](const LengthRowConsumer& consume) {
    match_fastable_lengths(scored(distances, sweeps.front().planned.front(), database, monitor),
                           lengths, match, monitor, consume);
  };
  if (any_relative(sweeps)) {
    for (LengthSweep& sweep : sweeps)
      sweep.maxima = std::make_unique<MaximumScan>(database.sequences.size(), resources.kernels);
    match_lengths([&](size_t l, const DistanceRow& row) { (*sweeps[l].maxima)(row); });
    for (LengthSweep& sweep : sweeps)
      for (QueryPlan& plan : sweep.planned)
        if (needs_maxima(plan)) set_relative_limits(plan, sweep.maxima->result());
  }
  for (LengthSweep& sweep : sweeps)
    sweep.hits = std::make_unique<HitScan>(widest_scan(sweep, share_of(resources, sweeps.size())));
  match_lengths([&](size_t l, const DistanceRow& row) { (*sweeps[l].hits)(row); });
  for (LengthSweep& sweep : sweeps) {
    sweep.found = sweep.hits->result();
    sweep.hits.reset();
  }
  const size_t thresholds = grid.thresholds.size();
  std::vector<CellCounts> cells(sweeps.size() * thresholds);
  StepCounter counter(monitor, "count", cells.size());
  parallel_for(cells.size(), monitor, [&](size_t c) {
    const LengthSweep& sweep = sweeps[c / thresholds];
    cells[c] = count_cell(sweep, sweep.planned[c % thresholds], truth, monitor);
    counter.add();
  });
  return cells;
}

std::vector<CellCounts> sweep_fabmap(const FabmapDatabase& database, const SequenceWords& query,
                                     const std::string& query_name, const FabmapQuerySettings& base,
                                     const Grid& grid, const TruthReader& read_truth, uint64_t seed,
                                     const Monitor& monitor) {
  check_grid(grid, base);
  const std::vector<uint32_t> place_of = database.places();
  const size_t thresholds = grid.thresholds.size();
  std::vector<std::vector<Match>> hits(grid.windows.size() * thresholds);
  std::vector<ViewWindow> windows(thresholds);
  const auto observe = [&](size_t frame, std::span<const double> posterior) {
    for (size_t t = 0; t < thresholds; ++t) {
      windows[t].add(posterior, *grid.thresholds[t], place_of.size());
      if (posterior.empty()) continue;
      for (size_t w = 0; w < grid.windows.size(); ++w)
        append_hits(hits[w * thresholds + t], frame, posterior, windows[t], grid.windows[w],
                    place_of);
    }
  };
  Result result = query_fabmap(database, query, query_name, base, seed, observe, monitor).result;
  const GroundTruth truth = read_truth(scope_of(result));
  std::vector<CellCounts> cells;
  for (size_t c = 0; c < hits.size(); ++c) {
    result.hits = std::move(hits[c]);
    cells.push_back({grid.windows[c / thresholds], grid.thresholds[c % thresholds], std::nullopt,
                     count_recognitions(result, truth)});
  }
  return cells;
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
