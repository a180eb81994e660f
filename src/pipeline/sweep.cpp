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
  std::vector<SequenceResult> planned;  // as many as thresholds
  std::unique_ptr<MaximumScan> maxima;
  std::unique_ptr<HitScan> hits;
  HitScanResult found;
};

std::vector<LengthSweep> plan_sweep(const SequenceDatabase& database, const DescriptorSet& query,
                                    const std::string& query_name,
                                    const SequenceQuerySettings& base, const SequenceGrid& grid,
                                    const QueryResources& resources, const Monitor& monitor) {
  if (grid.window_lengths.empty() || grid.distance_thresholds.empty())
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
  for (const uint64_t length : grid.window_lengths) {
    LengthSweep& sweep = sweeps.emplace_back();
    for (const auto& threshold : grid.distance_thresholds) {
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
  for (const SequenceResult& result : sweep.planned) {
    const HitScanSettings settings = scan_settings(result, resources);
    for (size_t s = 0; s < widest.limits.size(); ++s) widen(widest, settings, s);
  }
  return widest;
}

ThresholdScale automatic_scale(const SequenceResult& result) {
  for (const SequenceThreshold& sequence : result.sequences)
    if (sequence.threshold) return sequence.scale;
  return score_kind(result.settings.score).automatic_scale;
}

SequenceCellCounts count_cell(const LengthSweep& sweep, SequenceResult result,
                              const GroundTruth& truth, const Monitor& monitor) {
  const HitScanSettings limits = scan_settings(result, {});
  for (const Cell& hit : sweep.found.hits)
    if (hit.distance < limits.limit(hit.sequence, hit.query_window)) result.hits.push_back(hit);
  result.best = sweep.found.best;
  cluster(result, monitor);
  return {result.settings.window_length, result.settings.distance_threshold,
          result.settings.distance_threshold ? scale_of(result.settings) : automatic_scale(result),
          count_recognitions(result, truth, monitor)};
}

}  // namespace

std::vector<SequenceCellCounts> sweep_sequences(
    const SequenceDatabase& database, const DescriptorSet& query, const std::string& query_name,
    const SequenceQuerySettings& base, const SequenceGrid& grid, const TruthReader& read_truth,
    const QueryResources& resources, const Monitor& monitor) {
  std::vector<LengthSweep> sweeps =
      plan_sweep(database, query, query_name, base, grid, resources, monitor);
  const GroundTruth truth = read_truth(scope_of(sweeps.front().planned.front()));
  const FrameDistances distances =
      searched_distances(database, sweeps.front().planned.front(), query);
  const std::vector<size_t> lengths(grid.window_lengths.begin(), grid.window_lengths.end());
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
      for (SequenceResult& result : sweep.planned)
        if (needs_maxima(result)) set_relative_limits(result, sweep.maxima->result());
  }
  for (LengthSweep& sweep : sweeps)
    sweep.hits = std::make_unique<HitScan>(widest_scan(sweep, share_of(resources, sweeps.size())));
  match_lengths([&](size_t l, const DistanceRow& row) { (*sweeps[l].hits)(row); });
  for (LengthSweep& sweep : sweeps) {
    sweep.found = sweep.hits->result();
    sweep.hits.reset();
  }
  const size_t thresholds = grid.distance_thresholds.size();
  std::vector<SequenceCellCounts> cells(sweeps.size() * thresholds);
  StepCounter counter(monitor, "count", cells.size());
  parallel_for(cells.size(), monitor, [&](size_t c) {
    const LengthSweep& sweep = sweeps[c / thresholds];
    cells[c] = count_cell(sweep, sweep.planned[c % thresholds], truth, monitor);
    counter.add();
  });
  return cells;
}

SweepIntervals sequence_intervals(const SequenceDatabase& database, const DescriptorSet& query,
                                  const SequenceQuerySettings& settings,
                                  const TruthReader& read_truth, const QueryResources& resources,
                                  const Monitor& monitor) {
  Monitor quiet = monitor;  // the sweep has said what there is to say
  quiet.warn = nullptr;
  const SequenceResult result =
      run_query(plan_query(database, query, "", settings, resources, quiet), database, query,
                resources, {}, quiet)
          .result;
  const GroundTruth truth = read_truth(scope_of(result));
  const auto interval = [&](const auto& pairs, PlaceLabel wanted) {
    std::vector<double> counts(result.query_windows, 0);
    for (const auto& pair : pairs)
      if (truth.label(result.anchor(pair.query_window), pair.sequence,
                      result.anchor(pair.train_window)) == wanted)
        counts[pair.query_window] += 1;
    return bootstrap_sum(counts, std::min<size_t>(settings.window_length, counts.size()),
                         resources.seed);
  };
  return {std::min<size_t>(settings.window_length, result.query_windows),
          interval(result.hits, PlaceLabel::same), interval(result.hits, PlaceLabel::different),
          interval(result.places, PlaceLabel::same),
          interval(result.places, PlaceLabel::different)};
}

std::vector<FabmapCellCounts> sweep_fabmap(const FabmapDatabase& database,
                                           const SequenceWords& query,
                                           const std::string& query_name,
                                           const FabmapQuerySettings& base, const FabmapGrid& grid,
                                           const TruthReader& read_truth, uint64_t seed,
                                           const Monitor& monitor) {
  if (grid.windows.empty() || grid.place_thresholds.empty())
    throw Error(ErrorKind::usage, "give at least one c_w and one t_p");
  if (base.loop)
    throw Error(ErrorKind::usage, "a sweep has no loop mode; leave \"loop\" out of the settings");
  for (const uint64_t window : grid.windows)
    for (const double threshold : grid.place_thresholds) {
      FabmapQuerySettings settings = base;
      settings.window = window;
      settings.place_threshold = threshold;
      check_query_settings(settings);
    }
  const std::vector<uint32_t> place_of = database.places();
  const size_t thresholds = grid.place_thresholds.size();
  std::vector<std::vector<PlaceMatch>> hits(grid.windows.size() * thresholds);
  std::vector<ViewWindow> windows(thresholds);
  const auto observe = [&](size_t frame, std::span<const double> posterior) {
    for (size_t t = 0; t < thresholds; ++t) {
      windows[t].add(posterior, grid.place_thresholds[t], place_of.size());
      if (posterior.empty()) continue;
      for (size_t w = 0; w < grid.windows.size(); ++w)
        append_hits(hits[w * thresholds + t], frame, posterior, windows[t], grid.windows[w],
                    place_of);
    }
  };
  FabmapResult result =
      query_fabmap(database, query, query_name, base, seed, observe, monitor).result;
  const GroundTruth truth = read_truth(scope_of(result));
  std::vector<FabmapCellCounts> cells;
  for (size_t w = 0; w < grid.windows.size(); ++w) {
    for (size_t t = 0; t < thresholds; ++t) {
      result.hits = std::move(hits[w * thresholds + t]);
      cells.push_back(
          {grid.windows[w], grid.place_thresholds[t], count_recognitions(result, truth)});
    }
  }
  return cells;
}

SweepIntervals fabmap_intervals(const FabmapDatabase& database, const SequenceWords& query,
                                const FabmapQuerySettings& settings, const TruthReader& read_truth,
                                uint64_t seed, const Monitor& monitor) {
  constexpr size_t kFewestFrames = 8;  // about a second of walking
  const FabmapResult result = query_fabmap(database, query, "", settings, seed, {}, monitor).result;
  const GroundTruth truth = read_truth(scope_of(result));
  std::vector<double> correct(result.query_frames, 0);
  std::vector<double> incorrect(result.query_frames, 0);
  for (const PlaceMatch& hit : result.hits) {
    const PlaceLabel label = truth.label(hit.frame, 0, hit.place);
    if (label == PlaceLabel::same) correct[hit.frame] += 1;
    if (label == PlaceLabel::different) incorrect[hit.frame] += 1;
  }
  const size_t block =
      std::min(std::max<size_t>(settings.window, kFewestFrames), result.query_frames);
  return {
      block, bootstrap_sum(correct, block, seed), bootstrap_sum(incorrect, block, seed), {}, {}};
}

}  // namespace vpr
