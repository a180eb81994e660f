#include "tune/sweep.h"

#include <algorithm>
#include <cassert>
#include <deque>
#include <map>
#include <string>

#include "base/error.h"
#include "base/parallel.h"
#include "evaluate/judgment.h"

namespace vpr {
namespace {

bool has_error(const CellCounts& cell) {
  return cell.counts.recognitions.incorrect > 0 || cell.unknown_place.value_or(0) > 0;
}

bool is_superior(const LabelCounts& a, const LabelCounts& b) {
  return a.correct >= b.correct && a.incorrect <= b.incorrect &&
         (a.correct > b.correct || a.incorrect < b.incorrect);
}

// The reason for which no cell with a threshold is recommended.
Advice missing_advice(std::span<const CellCounts> cells) {
  const auto any = [&](uint64_t LabelCounts::*count) {
    return std::ranges::any_of(cells, [&](const CellCounts& cell) {
      return cell.threshold && cell.counts.recognitions.*count > 0;
    });
  };
  if (any(&LabelCounts::correct)) return Advice::always_errors;
  return any(&LabelCounts::incorrect) ? Advice::no_correct_recognitions : Advice::no_recognitions;
}

/// One window length: a plan for each threshold, and the matches for all of them.
struct LengthSweep {
  std::vector<QueryPlan> plans;                        // by threshold
  RecognitionScanResult found;                         // below the largest limit of any plan
  std::vector<std::optional<uint32_t>> margins;        // for a decision by margin
  std::vector<std::optional<uint32_t>> unknown_place;  // margins if the place were not trained
};

std::vector<LengthSweep> plan_sweep(const SequenceDatabase& database, const LabeledQuery& query,
                                    const SequenceQuerySettings& base, const Grid& grid,
                                    const QueryResources& resources, const Monitor& monitor) {
  assert(!grid.windows.empty() && !grid.thresholds.empty());
  // Most warnings are the same for every setting.
  const Monitor once = with_each_warning_once(monitor);
  std::vector<LengthSweep> sweeps(grid.windows.size());
  const size_t thresholds = grid.thresholds.size();
  // An automatic threshold, if there is one, needs what others need, and more.
  const size_t neediest =
      std::ranges::find(grid.thresholds, std::optional<double>{}) - grid.thresholds.begin();
  for (size_t l = 0; l < sweeps.size(); ++l) {
    const size_t first = l * thresholds;
    const PreparedDatabase prepared =
        prepare(database, settings_at(grid, first + neediest % thresholds, base), resources, once);
    std::vector<QueryPlan>& plans = sweeps[l].plans;
    for (size_t cell = first; cell < first + thresholds; ++cell) {
      const SequenceQuerySettings settings = settings_at(grid, cell, base);
      if (cell == first)
        plans = {plan_query(prepared, query.frames, query.name, settings, resources, once)};
      else
        plans.push_back(with_limit(plans.front(), prepared, settings, once));
    }
  }
  return sweeps;
}

// Finds recognitions below the largest limit of any threshold, for every sequence. Those of all
// `lengths` are in memory together.
RecognitionScanSettings widest_scan(const LengthSweep& sweep, size_t lengths) {
  RecognitionScanSettings widest = scan_settings(sweep.plans.front());
  widest.max_recognitions /= lengths;
  for (const QueryPlan& plan : sweep.plans)
    for (size_t s = 0; s < widest.limits.size(); ++s)
      widest.limits[s] = std::max(widest.limits[s], plan.result.sequences[s].distance_limit);
  return widest;
}

// Finds the matches of every length in one pass, after another one for relative limits.
void search(std::vector<LengthSweep>& lengths, const GroundTruth& truth, const Monitor& monitor) {
  const QueryPlan& first = lengths.front().plans.front();
  const FrameDistances distances = searched_distances(first);
  MatchSettings settings = first.match;
  settings.method = exact_methods().data();  // all exact methods yield the same cells
  std::vector<Pass> passes;
  for (const LengthSweep& length : lengths)
    passes.push_back({length.plans.front().match.window_length, {}});
  const auto match_all = [&] { match(scored(distances, first.scores), settings, passes, monitor); };
  if (std::ranges::any_of(lengths.front().plans, needs_maxima)) {
    std::deque<MaximumScan> maxima;
    for (Pass& pass : passes)
      pass.sinks = {{std::ref(maxima.emplace_back(first.result.sequences.size()))}};
    match_all();
    for (size_t l = 0; l < lengths.size(); ++l) {
      const std::vector<uint32_t> found = maxima[l].result();
      for (QueryPlan& plan : lengths[l].plans)
        if (needs_maxima(plan)) set_relative_limits(plan, found);
    }
  }
  const bool has_margins = std::holds_alternative<ByMargin>(first.decision);
  std::deque<RecognitionScan> recognitions;
  std::deque<MarginScan> margins;
  std::deque<UnknownPlaceScan> labeled;
  for (size_t l = 0; l < lengths.size(); ++l) {
    Sinks& sinks = passes[l].sinks;
    sinks = {{std::ref(recognitions.emplace_back(widest_scan(lengths[l], lengths.size())))}};
    if (!has_margins) continue;
    const QueryPlan& plan = lengths[l].plans.front();
    sinks.rows = {
        std::ref(margins.emplace_back(*first.exclusion_zones, plan.result.query_windows)),
        std::ref(labeled.emplace_back(truth, *first.exclusion_zones, plan.match.window_length,
                                      plan.result.query_windows))};
  }
  match_all();
  for (size_t l = 0; l < lengths.size(); ++l) {
    lengths[l].found = recognitions[l].result();
    if (!has_margins) continue;
    lengths[l].margins = margins[l].result();
    lengths[l].unknown_place = labeled[l].result();
  }
}

// The result of one threshold: the matches below its own limits.
Result cell_result(const LengthSweep& length, size_t threshold, const Monitor& monitor) {
  const QueryPlan& plan = length.plans[threshold];
  RecognitionScanResult found{{}, length.found.best};
  for (const Cell& recognition : length.found.recognitions)
    if (recognition.score < plan.result.sequences[recognition.sequence].distance_limit)
      found.recognitions.push_back(recognition);
  Result result = make_result(plan, found, length.margins);
  cluster(result, monitor);
  return result;
}

// The number of windows that would reach the margin, a number, if their place were not trained.
std::optional<uint64_t> untrained_windows(const LengthSweep& length, std::optional<double> least) {
  if (length.unknown_place.empty() || !least) return std::nullopt;
  const QueryPlan& plan = length.plans.front();
  return std::ranges::count_if(length.unknown_place, [&](const auto& margin) {
    return margin && plan.result.score().frame_value(*margin, plan.match.window_length) >= *least;
  });
}

void check_grid(const Grid& grid, const FabmapQuerySettings& base) {
  assert(!grid.windows.empty() && !grid.thresholds.empty());
  if (base.loop)
    throw Error(ErrorKind::usage, "a sweep cannot query loops. Omit \"loop\" in the settings.");
  for (size_t cell = 0; cell < grid.windows.size() * grid.thresholds.size(); ++cell)
    check_query_settings(settings_at(grid, cell, base));
}

// The number of consecutive windows in a bootstrap block.
size_t block_of(const Result& result) {
  constexpr size_t kFewestFrames = 8;  // about one second
  const auto* fabmap = std::get_if<FabmapQuerySettings>(&result.settings);
  const size_t block =
      fabmap == nullptr ? result.window_length() : std::max<size_t>(fabmap->window, kFewestFrames);
  return std::min(block, result.query_windows);
}

// The scale of t_r; nullopt for a margin or t_p.
std::optional<ThresholdScale> threshold_scale(const Result& result) {
  const auto* settings = std::get_if<SequenceQuerySettings>(&result.settings);
  if (settings == nullptr || decision_of(settings->rule) == Decision::margin) return std::nullopt;
  return limit_of(settings->rule) ? scale_of(*settings) : ThresholdScale::bits;
}

// Counts every cell, by window, then threshold. `shape`: a result without matches. `result_of`: of
// a cell, from any thread. `untrained_of`: CellCounts::unknown_place of a cell.
template <class ResultOf, class UntrainedOf>
Sweep count_cells(const Result& shape, const Grid& grid, const ResultOf& result_of,
                  const UntrainedOf& untrained_of, const GroundTruth& truth, uint64_t seed,
                  const Monitor& monitor) {
  Sweep sweep;
  sweep.grid = grid;
  sweep.query = shape.query;
  sweep.score = &shape.score();
  sweep.protocol = truth.protocol;
  sweep.threshold_symbol = sweep.score->threshold_symbol;
  sweep.threshold_order = sweep.score->order;
  if (const auto* settings = std::get_if<SequenceQuerySettings>(&shape.settings)) {
    const DecisionKind& kind = decision_kind(decision_of(settings->rule));
    sweep.threshold_symbol = kind.symbol;
    sweep.threshold_order = kind.order;
  }
  const size_t thresholds = grid.thresholds.size();
  sweep.cells.resize(grid.windows.size() * thresholds);
  StepCounter counter(monitor, "count", sweep.cells.size());
  parallel_for(sweep.cells.size(), monitor, [&](size_t c) {
    const Result result = result_of(c);
    const Judgment judgment = judge(result, truth, {});
    sweep.cells[c] = {grid.windows[c / thresholds],
                      grid.thresholds[c % thresholds],
                      threshold_scale(result),
                      count_recognitions(result, truth, monitor),
                      untrained_of(c),
                      judgment.localization};
    sweep.cells[c].counts.best_match = best_match_counts(judgment.outcomes);
    counter.add();
  });
  sweep.recommendation = recommend(sweep.cells, sweep.threshold_order);
  if (!sweep.recommendation.cell) return sweep;
  const Result recommended = result_of(*sweep.recommendation.cell);
  sweep.recommended_settings = recommended.settings;
  sweep.intervals = count_intervals(recommended, truth, seed);
  return sweep;
}

}  // namespace

SequenceQuerySettings settings_at(const Grid& grid, size_t cell, SequenceQuerySettings base) {
  const uint64_t length = grid.windows[cell / grid.thresholds.size()];
  if (auto* threshold = std::get_if<Threshold>(&base.rule))
    threshold->windows.window_length = length;
  if (auto* margin = std::get_if<Margin>(&base.rule)) margin->windows.window_length = length;
  set_limit(base.rule, grid.thresholds[cell % grid.thresholds.size()]);
  return base;
}

FabmapQuerySettings settings_at(const Grid& grid, size_t cell, FabmapQuerySettings base) {
  base.window = grid.windows[cell / grid.thresholds.size()];
  base.place_threshold = grid.thresholds[cell % grid.thresholds.size()].value();
  return base;
}

void UnknownPlaceScan::operator()(std::span<const ScoreRow> row) {
  const size_t anchor = window_length_ - 1;
  std::vector<ScoreRow> unknown_place;
  for (const ScoreRow& piece : row) {
    const size_t width = zones_.widths[piece.sequence];
    const size_t first = piece.train_window + anchor;  // frames of the piece: [first, end)
    const size_t end = first + piece.scores.size();
    size_t next = first;
    for (const LabelStretch& run :
         label_runs(truth_, piece.query_window + anchor, piece.sequence, end + width)) {
      const size_t begin = run.first - std::min(run.first, width);
      if (begin > next) unknown_place.push_back(part_of_row(piece, next - first, begin - next));
      next = std::max(next, run.last + width + 1);
    }
    if (next < end) unknown_place.push_back(part_of_row(piece, next - first, end - next));
  }
  if (!unknown_place.empty()) untrained_(unknown_place);
}

std::optional<double> looseness_of(const CellCounts& cell, ScoreOrder order) {
  if (!cell.threshold) return std::nullopt;
  return order == ScoreOrder::distance ? *cell.threshold : -*cell.threshold;
}

size_t best_counts(std::span<const FrameCounts> counts, uint64_t max_incorrect) {
  const auto is_better = [&](const FrameCounts& a, const FrameCounts& b) {
    const bool is_allowed = a.incorrect() <= max_incorrect;
    if (is_allowed != (b.incorrect() <= max_incorrect)) return is_allowed;
    const auto rank = [&](const FrameCounts& one) {
      const auto loss = -static_cast<int64_t>(one.path.correct);
      const auto incorrect = static_cast<int64_t>(one.incorrect());
      return is_allowed ? std::pair(loss, incorrect) : std::pair(incorrect, loss);
    };
    return rank(a) < rank(b);
  };
  return static_cast<size_t>(std::ranges::min_element(counts, is_better) - counts.begin());
}

Recommendation recommend(std::span<const CellCounts> cells, ScoreOrder order) {
  Recommendation choice;
  std::map<uint64_t, std::vector<size_t>> by_window;  // cells with a threshold
  for (size_t i = 0; i < cells.size(); ++i) {
    if (cells[i].threshold) by_window[cells[i].window].push_back(i);
    if (std::ranges::none_of(cells, [&](const CellCounts& other) {
          return is_superior(other.counts.recognitions, cells[i].counts.recognitions);
        }))
      choice.pareto.push_back(i);
  }
  if (by_window.empty()) {
    choice.advice = cells.empty() ? Advice::no_recognitions : Advice::only_automatic;
    return choice;
  }
  std::map<uint64_t, size_t> first_errors;  // by window
  for (auto& [window, thresholds] : by_window) {
    std::ranges::stable_sort(thresholds, {},
                             [&](size_t cell) { return *looseness_of(cells[cell], order); });
    const auto error =
        std::ranges::find_if(thresholds, [&](size_t cell) { return has_error(cells[cell]); });
    if (error != thresholds.end()) first_errors[window] = *error;
    for (auto cell = thresholds.begin(); cell != error; ++cell) {
      const bool is_last = cell + 1 == error && !cells[*cell].unknown_place;
      std::optional<size_t>& best = is_last ? choice.near_miss : choice.cell;
      const uint64_t least = best ? cells[*best].counts.recognitions.correct : 0;
      if (cells[*cell].counts.recognitions.correct > least) best = *cell;  // ties to the first
    }
  }
  choice.advice = choice.cell ? Advice::recommended : missing_advice(cells);
  if (choice.cell) choice.near_miss.reset();
  const auto& named = choice.cell ? choice.cell : choice.near_miss;
  if (!named) return choice;
  if (const auto error = first_errors.find(cells[*named].window); error != first_errors.end())
    choice.first_error = error->second;
  if (!choice.cell) choice.advice = choice.first_error ? Advice::next_errs : Advice::grid_ends;
  return choice;
}

Sweep sweep_sequences(const SequenceDatabase& database, const LabeledQuery& query,
                      const SequenceQuerySettings& base, const Grid& grid,
                      const QueryResources& resources, const Monitor& monitor) {
  std::vector<LengthSweep> lengths = plan_sweep(database, query, base, grid, resources, monitor);
  const Result shape = lengths.front().plans.front().result;
  const GroundTruth truth = whole_truth_of(query.by, scope_of(shape), monitor);
  search(lengths, truth, monitor);
  const size_t thresholds = grid.thresholds.size();
  const auto result_of = [&](size_t cell) {
    return cell_result(lengths[cell / thresholds], cell % thresholds, monitor);
  };
  const auto untrained_of = [&](size_t cell) {
    return untrained_windows(lengths[cell / thresholds], grid.thresholds[cell % thresholds]);
  };
  return count_cells(shape, grid, result_of, untrained_of, truth, resources.seed, monitor);
}

Sweep sweep_fabmap(const FabmapDatabase& database, const LabeledWords& query,
                   const FabmapQuerySettings& base, const Grid& grid, uint64_t seed,
                   const Monitor& monitor) {
  check_grid(grid, base);
  const std::vector<uint32_t> place_of = database.places();
  const size_t thresholds = grid.thresholds.size();
  std::vector<std::vector<Match>> recognitions(grid.windows.size() * thresholds);
  std::vector<ViewWindow> windows(thresholds);
  const auto observe = [&](size_t frame, std::span<const double> posterior) {
    // A frame without words recognizes nothing.
    const std::span<const double> shown =
        query.frames.words[frame].empty() ? std::span<const double>{} : posterior;
    for (size_t t = 0; t < thresholds; ++t) {
      windows[t].add(shown, *grid.thresholds[t], place_of.size());
      for (size_t w = 0; w < grid.windows.size(); ++w)
        append_recognitions(recognitions[w * thresholds + t], frame, shown, windows[t],
                            grid.windows[w], place_of);
    }
  };
  const Result all =
      query_fabmap(database, query.frames, query.name, base, seed, observe, monitor).result;
  const auto result_of = [&](size_t cell) {
    Result result = all;
    result.settings = settings_at(grid, cell, base);
    result.recognitions = recognitions[cell];
    return result;
  };
  const auto untrained_of = [](size_t) { return std::nullopt; };
  const GroundTruth truth = whole_truth_of(query.by, scope_of(all), monitor);
  return count_cells(all, grid, result_of, untrained_of, truth, seed, monitor);
}

SweepIntervals count_intervals(const Result& result, const GroundTruth& truth, uint64_t seed) {
  const size_t length = result.window_length();
  const size_t block = block_of(result);
  const auto interval = [&](const auto& matches, auto query, PlaceLabel wanted) {
    std::vector<double> counts(result.query_windows, 0);
    for (const auto& match : matches)
      if (label_of(truth, match, length) == wanted) counts[match.*query] += 1;
    return bootstrap_sum(counts, block, seed);
  };
  SweepIntervals intervals{block, interval(result.recognitions, &Match::query, PlaceLabel::same),
                           interval(result.recognitions, &Match::query, PlaceLabel::different)};
  if (!result.clusters) return intervals;
  const std::vector<Cluster>& clusters = result.clusters->all;
  intervals.correct_clusters = interval(clusters, &Cluster::query_window, PlaceLabel::same);
  intervals.incorrect_clusters = interval(clusters, &Cluster::query_window, PlaceLabel::different);
  return intervals;
}

}  // namespace vpr
