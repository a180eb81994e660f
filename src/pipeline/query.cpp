#include "pipeline/query.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/counted.h"
#include "base/error.h"
#include "base/step_parts.h"
#include "base/stopwatch.h"
#include "matching/fastable_batch.h"
#include "matching/views.h"
#include "pipeline/query_steps.h"
#include "pipeline/score_basis.h"
#include "pipeline/thresholds.h"
#include "pipeline/train.h"
#include "pipeline/verify.h"

namespace vpr {
namespace {

void check_settings(const SequenceQuerySettings& settings) {
  check_window_length(settings.window_length);
  if (settings.safety_factor) check_safety_factor(*settings.safety_factor);
  if (settings.distance_threshold && !std::isfinite(*settings.distance_threshold))
    throw Error(ErrorKind::usage, "t_r must be a finite number or auto");
  check_score(settings);
  if (settings.clustering.eps < 0 || settings.clustering.eps > kMaxEps)
    throw Error(ErrorKind::usage, fmt::format("clustering.eps must be from 0 to {}, found {}",
                                              kMaxEps, settings.clustering.eps));
}

void check_names(const SequenceDatabase& database, const SequenceQuerySettings& settings) {
  std::vector<std::string> names;
  for (const TrainSequence& sequence : database.sequences) names.push_back(sequence.name);
  for (const std::string& name : settings.only_sequences)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw Error(ErrorKind::usage, fmt::format("the database has no sequence \"{}\"; it has {}",
                                                name, fmt::join(names, ", ")));
}

// Of an approximate method, the largest distance is not known.
void check_exactness(const SequenceQuerySettings& settings) {
  if (find_sequence_method(settings.method).is_exact) return;
  if (settings.distance_threshold && scale_of(settings) == ThresholdScale::relative)
    throw Error(ErrorKind::usage,
                fmt::format("{} does not see every window, and so not max(D); give t_r in bits a "
                            "frame, as in --t-r 200 --t-r-scale bits, or auto",
                            settings.method));
}

bool is_searched(const SequenceQuerySettings& settings, const std::string& name) {
  const auto& only = settings.only_sequences;
  return only.empty() || std::find(only.begin(), only.end(), name) != only.end();
}

std::vector<Target> plan_sequences(const SequenceDatabase& database,
                                   const SequenceQuerySettings& settings, const Monitor& monitor) {
  std::vector<Target> planned;
  bool any = false;
  const std::vector<DescriptorSpan> spans = code_spans(database);
  for (size_t s = 0; s < spans.size(); ++s) {
    Target& sequence = planned.emplace_back();
    sequence.name = database.sequences[s].name;
    sequence.frames = spans[s].rows.size();
    sequence.windows = count_windows(readable_runs(spans[s]), settings.window_length);
    sequence.searched = is_searched(settings, sequence.name);
    if (!sequence.searched) continue;
    any = any || sequence.windows > 0;
    if (sequence.windows == 0)
      warn(monitor, fmt::format("{}: has no {} readable frames in a row (c_l), so it can't be "
                                "recognised",
                                sequence.name, settings.window_length));
  }
  if (!any)
    throw Error(ErrorKind::usage,
                fmt::format("no training sequence has {} readable frames in a row; give a smaller "
                            "--c-l",
                            settings.window_length));
  return planned;
}

// Databases of older date have no closest windows of a single sequence.
const ThresholdTable* stored_table(const SequenceDatabase& database, size_t window_length) {
  const ThresholdTable* table = find_thresholds(database.thresholds, window_length);
  const bool is_old = table != nullptr && table->closest.size() == 1 && !table->closest[0];
  return is_old ? nullptr : table;
}

// What the database holds, or else computed. Closest windows of standardized scores depend on the
// settings, and are computed for each query.
ThresholdTable automatic_table(const SequenceDatabase& database,
                               const SequenceQuerySettings& settings,
                               const QueryResources& resources, const Monitor& monitor) {
  const MatchSettings match{settings.window_length, resources.memory_limit, resources.kernels};
  if (!score_kind(settings.score).is_stored)
    return closest_windows(database, settings, match, monitor);
  const ThresholdTable* stored = stored_table(database, settings.window_length);
  if (stored != nullptr) return *stored;
  if (is_left_to_queries(code_spans(database)))
    warn(monitor, fmt::format("the database has no automatic t_r for c_l {}: computing it, which "
                              "takes a while; vpr-tune threshold DB --c-l {} --write keeps it",
                              settings.window_length, settings.window_length));
  ThresholdTable table = closest_windows(database, settings, match, monitor);
  table.safety_factor = database.thresholds.empty() ? 1 : database.thresholds.front().safety_factor;
  return table;
}

void plan_automatic_thresholds(QueryPlan& result, const SequenceDatabase& database,
                               const QueryResources& resources, const Monitor& monitor) {
  SequenceQuerySettings settings = result.settings;
  ThresholdTable table = automatic_table(database, settings, resources, monitor);
  if (!settings.safety_factor) settings.safety_factor = table.safety_factor;
  const AutomaticThresholds automatic =
      automatic_thresholds(database, std::move(table), settings, monitor);
  for (size_t s = 0; s < result.sequences.size(); ++s) {
    Target& sequence = result.sequences[s];
    sequence.scale = automatic_scale(result.sequences.size(), settings);
    if (sequence.searched && automatic.sequences[s])
      sequence.threshold = automatic.sequences[s]->value;
  }
}

// Limits that need no distances: automatic thresholds, and numbers that are not relative.
void plan_limits(QueryPlan& result, const SequenceDatabase& database, const DescriptorSet& query) {
  const uint64_t length = result.settings.window_length;
  const std::vector<DescriptorSpan> spans = code_spans(database);
  for (size_t s = 0; s < spans.size(); ++s) {
    Target& sequence = result.sequences[s];
    if (!sequence.threshold) continue;
    if (sequence.scale == ThresholdScale::mean && sequence.searched)
      set_mean_limits(sequence, mean_window_distances(
                                    frame_distances({&spans[s], 1}, {query.rows(), {}}), length));
    if (sequence.scale == ThresholdScale::bits)
      sequence.distance_limit = distance_limit(*sequence.threshold, static_cast<double>(length));
    if (sequence.scale == ThresholdScale::mean_z)
      sequence.distance_limit = score_limit(*sequence.threshold, length);
  }
}

// Compares with an exact search of everything.
SearchRecall measure_recall(const QueryPlan& plan, const HitScanResult& approximate,
                            const FrameDistances& distances, const MatchSettings& match,
                            const QueryResources& resources, const Monitor& monitor) {
  HitScan scan(scan_settings(plan, resources));
  match_fastable(distances, match, monitor, std::ref(scan));
  const HitScanResult exact = scan.result();
  SearchRecall recall;
  recall.hits = exact.hits.size();
  for (size_t window = 0; window < exact.best.size(); ++window) {
    if (!exact.best[window]) continue;
    ++recall.windows;
    const auto& found = approximate.best[window];
    if (found && found->distance == exact.best[window]->distance) ++recall.found_best;
  }
  return recall;
}

void check_cells(const std::vector<Cell>& cells, const SequenceDatabase& database,
                 const DescriptorSet& query, const SequenceQuerySettings& settings,
                 const Monitor& monitor) {
  if (cells.empty()) return;
  const std::optional<ScoreBasis> basis = score_basis(database, settings);
  const std::vector<Cell> wrong = basis ? wrong_scores(cells, code_spans(database), query.span(),
                                                       settings.window_length, *basis, monitor)
                                        : wrong_cells(cells, code_spans(database), query.rows(),
                                                      settings.window_length, monitor);
  if (wrong.empty()) return;
  const Cell& first = wrong.front();
  throw Error(ErrorKind::expectation,
              fmt::format("{}, {}; the first is query window {}, {} window {}, "
                          "which should be {}",
                          counted(cells.size(), "cell"), counted(wrong.size(), "difference"),
                          first.query_window, database.sequences[first.sequence].name,
                          first.train_window, first.distance));
}

std::optional<ResultViews> find_views(const SequenceDatabase& database,
                                      const DescriptorSet& query) {
  if (!database.statistics) return std::nullopt;
  const double typical = database.statistics->typical_distance;
  ResultViews views{view_starts(query.span(), typical), {}};
  for (const DescriptorSpan& sequence : code_spans(database))
    views.train.push_back(view_starts(sequence, typical));
  return views;
}

}  // namespace

QueryPlan plan_query(const SequenceDatabase& database, const DescriptorSet& query,
                     const std::string& query_name, const SequenceQuerySettings& settings,
                     const QueryResources& resources, const Monitor& monitor) {
  check_settings(settings);
  check_exactness(settings);
  check_names(database, settings);
  check_descriptors(database, query, settings);
  QueryPlan result;
  result.settings = settings;
  result.settings.threshold_scale = scale_of(settings);
  result.query_name = query_name;
  result.query_frames = query.frames.count();
  result.query_unreadable = query.frames.unreadable;
  if (count_windows(readable_runs(query.span()), settings.window_length) == 0)
    throw Error(
        ErrorKind::usage,
        fmt::format("the query {} has {}, and no {} readable ones in a row (c_l); "
                    "give a smaller --c-l",
                    query_name, counted(result.query_frames, "frame"), settings.window_length));
  result.query_windows = result.query_frames - settings.window_length + 1;
  if (!result.query_unreadable.empty())
    warn(monitor,
         fmt::format("{}: {} of {} can't be decoded and will never match", query_name,
                     result.query_unreadable.size(), counted(result.query_frames, "frame")));
  result.sequences = plan_sequences(database, settings, monitor);
  if (settings.distance_threshold) {
    for (Target& sequence : result.sequences) {
      sequence.threshold = settings.distance_threshold;
      sequence.scale = scale_of(settings);
    }
  } else {
    plan_automatic_thresholds(result, database, resources, monitor);
  }
  plan_limits(result, database, query);
  if (score_kind(settings.score).needs_statistics && database.statistics)
    result.statistics = {database.statistics->settings, database.statistics->typical_distance};
  return result;
}

QueryRun run_query(QueryPlan planned, const SequenceDatabase& database, const DescriptorSet& query,
                   const QueryResources& resources, const std::vector<RowConsumer>& observers,
                   const Monitor& monitor) {
  QueryRun run;
  const SequenceMethod& method = find_sequence_method(planned.settings.method);
  const MatchSettings match{planned.settings.window_length, resources.memory_limit,
                            resources.kernels, planned.settings.lsh, resources.seed};
  FrameDistances distances = searched_distances(database, planned, query);

  // A relative threshold is known only after all distances were seen once.
  const bool has_two_passes = needs_maxima(planned);
  const Monitor last_pass = has_two_passes ? part_of(monitor, "pass", 1, 2) : monitor;
  Stopwatch watch;
  if (has_two_passes) {
    MaximumScan scan(planned.sequences.size(), resources.kernels);
    method.match(distances, match, part_of(monitor, "pass", 0, 2), std::ref(scan));
    set_relative_limits(planned, scan.result());
    run.seconds["maximum"] = watch.elapsed_s();
  }

  watch = {};
  HitScan scan(scan_settings(planned, resources));
  CellScan cells(choose_cells(distances.train_runs, distances.query_runs, match.window_length,
                              method.is_exact ? resources.verify_cells : 0, resources.seed));
  distances = scored(std::move(distances), planned, database, last_pass);
  method.match(distances, match, last_pass, [&](const DistanceRow& row) {
    scan(row);
    cells(row);
    for (const RowConsumer& observe : observers) observe(row);
  });
  HitScanResult found = scan.result();
  const std::vector<Cell> verified =
      method.is_exact ? cells.result()
                      : choose_found(found, resources.verify_cells, resources.seed);
  run.result = make_result(planned, found);
  run.seconds["match"] = watch.elapsed_s();

  if (!method.is_exact) {
    watch = {};
    run.result.recall = measure_recall(planned, found, distances, match, resources, monitor);
    run.seconds["recall"] = watch.elapsed_s();
  }

  watch = {};
  if (resources.verify_cells > 0 && verified.empty())
    warn(monitor, fmt::format("{} found no cell that could be verified", method.name));
  check_cells(verified, database, query, planned.settings, monitor);
  run.verified_cells = verified.size();
  if (resources.verify_cells > 0) run.seconds["verify"] = watch.elapsed_s();

  watch = {};
  found = {};  // clustering needs the memory
  cluster(run.result, monitor);
  run.seconds["cluster"] = watch.elapsed_s();
  run.result.views = find_views(database, query);
  return run;
}

}  // namespace vpr
