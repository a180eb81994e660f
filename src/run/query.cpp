#include "run/query.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <unordered_set>

#include <fmt/format.h>

#include "base/error.h"
#include "base/monitor.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "match/lsh.h"
#include "match/match.h"
#include "match/reference.h"
#include "match/score_kernels.h"

namespace vpr {
namespace {

// The sequence and index of the index-th window, counted over all runs.
std::pair<size_t, size_t> find_window(const std::vector<FrameRun>& runs, size_t window_length,
                                      uint64_t index) {
  for (const FrameRun& run : runs) {
    const size_t windows = run.windows(window_length);
    if (index < windows) return {run.sequence, run.first_in_sequence + index};
    index -= windows;
  }
  return {};
}

// Up to `count` different numbers below `bound`, by Floyd's algorithm.
std::unordered_set<uint64_t> choose_indices(uint64_t bound, uint64_t count, uint64_t seed) {
  RandomEngine engine(seed);
  std::unordered_set<uint64_t> chosen;
  for (uint64_t j = bound - std::min(bound, count); j < bound; ++j) {
    const uint64_t drawn = uniform_below(engine, j + 1);
    if (!chosen.insert(drawn).second) chosen.insert(j);
  }
  return chosen;
}

void check_cells(const std::vector<Cell>& cells, const QueryPlan& plan, const Monitor& monitor) {
  const size_t length = plan.match.window_length;
  const std::vector<Cell> wrong =
      plan.basis ? wrong_scores(cells, plan.train, plan.query, length, *plan.basis, monitor)
                 : wrong_cells(cells, plan.train, plan.query.rows, length, monitor);
  if (wrong.empty()) return;
  const Cell& first = wrong.front();
  throw Error(ErrorKind::expectation,
              fmt::format("{}, {}; the first is query window {}, {} window {}, "
                          "which should be {}",
                          counted(cells.size(), "cell"), counted(wrong.size(), "difference"),
                          first.query_window, plan.sequences[first.sequence].sequence.name,
                          first.train_window, first.score));
}

/// Measures consecutive steps.
class StepTimer {
 public:
  explicit StepTimer(std::map<std::string, double>& seconds) : seconds_(seconds) {}
  void end_step(const char* name) {
    seconds_[name] = watch_.elapsed_s();
    watch_ = {};
  }

 private:
  std::map<std::string, double>& seconds_;
  Stopwatch watch_;
};

// The first frames of stretches of similar frames in the query and the training sequences.
std::optional<ResultKeyframes> find_views(const QueryPlan& plan) {
  if (!plan.typical_distance) return std::nullopt;
  ResultKeyframes views{keyframe_starts(plan.query, *plan.typical_distance), {}};
  for (const DescribedFrames& sequence : plan.train)
    views.train.push_back(keyframe_starts(sequence, *plan.typical_distance));
  return views;
}

void finish(QueryRun& run, const QueryPlan& plan, StepTimer& timer, const Monitor& monitor) {
  cluster(run.result, monitor);
  timer.end_step("cluster");
  run.result.views = find_views(plan);
}

SearchRecall recall_of(const RecognitionScanResult& found, const RecognitionScanResult& exact) {
  SearchRecall recall;
  recall.recognitions = exact.recognitions.size();
  for (size_t window = 0; window < exact.best.size(); ++window) {
    if (!exact.best[window]) continue;
    ++recall.windows;
    const auto& best = found.best[window];
    if (best && best->score == exact.best[window]->score) ++recall.found_best;
  }
  return recall;
}

QueryRun query_lsh(const QueryPlan& plan, const QueryResources& resources, const Monitor& monitor) {
  FrameDistances distances = searched_distances(plan);
  for (size_t s = 0; s < plan.sequences.size(); ++s)
    if (!plan.sequences[s].searched) distances.train[s] = {};
  QueryRun run;
  StepTimer timer(run.seconds);
  RecognitionScan some(scan_settings(plan, resources));
  match_lsh(distances, plan.match, monitor, std::ref(some));
  const RecognitionScanResult found = some.result();
  run.result = make_result(plan, found);
  timer.end_step("match");
  RecognitionScan all(scan_settings(plan, resources));
  match(distances, plan.match, {{std::ref(all)}}, monitor);
  run.result.recall = recall_of(found, all.result());
  timer.end_step("recall");
  finish(run, plan, timer, monitor);
  return run;
}

}  // namespace

PathRows::PathRows(const QueryPlan& plan)
    : plan_(plan),
      decisions_(least_margin(plan)),
      steps_(plan.query_sequence.frames),
      best_(plan.query_sequence.frames),
      path_(plan.query_sequence.frames) {}

void PathRows::operator()(std::span<const ScoreRow> row) {
  const PathReport& report = *row.front().path;
  const size_t frame = row.front().query_window;
  steps_[frame] = report;
  steps_[frame].matches = {};
  for (const Cell& match : report.matches) best_[match.query_window] = match;
  if (report.rate) path_.rates[frame] = *report.rate;
  path_.numbers[frame] = report.path;
  decide(decisions_.take(report), frame);
}

void PathRows::decide(const std::vector<Cell>& recognized, size_t frame) {
  for (const Cell& match : recognized)
    path_.decided[match.query_window] = static_cast<double>(frame);
}

Result PathRows::result() {
  if (!steps_.empty() && steps_.back().path != 0) decide(decisions_.finish(), steps_.size() - 1);
  const std::vector<uint32_t> settled = settled_margins(std::move(steps_));
  std::vector<std::optional<uint32_t>> margins(best_.size());
  for (size_t frame = 0; frame < best_.size(); ++frame)
    if (best_[frame]) margins[frame] = settled[frame];
  Result result = make_result(plan_, {{}, best_}, margins);
  result.path = std::move(path_);
  return result;
}

uint32_t least_margin(const QueryPlan& plan) {
  const double per_unit = score_kind(plan.settings.score).frame_value(1, 1);
  return static_cast<uint32_t>(std::ceil(*plan.settings.margin / per_unit));
}

ResultRows::ResultRows(const QueryPlan& plan, const QueryResources& resources)
    : plan_(plan), recognitions_(scan_settings(plan, resources)) {
  if (plan.match.method->has_paths)
    paths_.emplace(plan);
  else if (plan.exclusion_zones)
    scan_.emplace(*plan.exclusion_zones, plan.query_windows, resources.kernels);
}

Sinks ResultRows::sinks() {
  if (paths_) return {{}, {std::ref(*paths_)}};
  Sinks sinks{{std::ref(recognitions_)}, {}};
  if (scan_) sinks.rows.push_back(std::ref(*scan_));
  return sinks;
}

Result ResultRows::result() {
  if (paths_) return paths_->result();
  return make_result(plan_, recognitions_.result(),
                     scan_ ? scan_->result() : std::vector<std::optional<uint32_t>>{});
}

std::vector<Cell> choose_cells(const FrameDistances& distances, size_t window_length, size_t count,
                               uint64_t seed) {
  const uint64_t columns = count_windows(distances.train_runs, window_length);
  const uint64_t all = columns * count_windows(distances.query_runs, window_length);
  std::vector<Cell> cells;
  for (const uint64_t index : choose_indices(all, count, seed)) {
    const size_t query = find_window(distances.query_runs, window_length, index / columns).second;
    const auto [sequence, train] =
        find_window(distances.train_runs, window_length, index % columns);
    cells.push_back({static_cast<uint32_t>(query), static_cast<uint32_t>(sequence),
                     static_cast<uint32_t>(train), 0});
  }
  std::sort(cells.begin(), cells.end(), by_position);
  return cells;
}

std::vector<Cell> wrong_cells(std::span<const Cell> cells, std::span<const DescribedFrames> train,
                              const DescriptorRows& query, size_t window_length,
                              const Monitor& monitor) {
  std::vector<uint32_t> correct(cells.size());
  parallel_for(cells.size(), monitor, [&](size_t i) {
    correct[i] = reference_window_distance(train[cells[i].sequence].rows, cells[i].train_window,
                                           query, cells[i].query_window, window_length);
  });
  std::vector<Cell> wrong;
  for (size_t i = 0; i < cells.size(); ++i) {
    if (cells[i].score == correct[i]) continue;
    wrong.push_back(cells[i]);
    wrong.back().score = correct[i];
  }
  return wrong;
}

std::vector<Cell> wrong_scores(std::span<const Cell> cells, std::span<const DescribedFrames> train,
                               const DescribedFrames& query, size_t window_length,
                               const ScoreBasis& basis, const Monitor& monitor) {
  const ReferenceUpdates updates = reference_updates(train, query, basis, monitor);
  std::vector<size_t> first_frame;
  size_t frames = 0;
  for (const DescribedFrames& sequence : train) {
    first_frame.push_back(frames);
    frames += sequence.rows.size();
  }
  std::vector<double> correct(cells.size(), 0);  // in standard deviations
  parallel_for(cells.size(), monitor, [&](size_t c) {
    const Cell& cell = cells[c];
    // Only offline scores depend on frames after the window.
    const size_t known = basis.offline ? query.rows.size() : cell.query_window + window_length;
    for (size_t k = 0; k < window_length; ++k) {
      const size_t i = cell.train_window + k;
      const size_t frame = first_frame[cell.sequence] + i;
      correct[c] +=
          reference_frame_scores(train[cell.sequence].rows[i], frame, query.rows.first(known),
                                 updates, basis)[cell.query_window + k];
    }
  });
  const double tolerance = score_tolerance(window_length) * kScoreUnit;
  std::vector<Cell> wrong;
  for (size_t c = 0; c < cells.size(); ++c) {
    const double found = static_cast<double>(cells[c].score - score_offset(window_length));
    const double expected = correct[c] * kScoreUnit;
    if (std::abs(found - expected) <= tolerance) continue;
    wrong.push_back(cells[c]);
    wrong.back().score =
        static_cast<uint32_t>(std::llround(expected) + score_offset(window_length));
  }
  return wrong;
}

QueryRun run_query(QueryPlan plan, const QueryResources& resources, const Sinks& observers,
                   const Monitor& monitor) {
  if (plan.is_approximate) return query_lsh(plan, resources, monitor);
  QueryRun run;
  FrameDistances distances = searched_distances(plan);
  StepTimer timer(run.seconds);

  // Relative thresholds need the largest of all distances first.
  const bool has_two_passes = needs_maxima(plan);
  if (has_two_passes) {
    MaximumScan scan(plan.sequences.size(), resources.kernels);
    match(distances, plan.match, {{std::ref(scan)}}, part_of(monitor, "pass", 0, 2));
    set_relative_limits(plan, scan.result());
    timer.end_step("maximum");
  }
  const Monitor last_pass = has_two_passes ? part_of(monitor, "pass", 1, 2) : monitor;
  distances = scored(std::move(distances), plan, last_pass);
  CellScan cells(
      choose_cells(distances, plan.match.window_length, resources.verify_cells, resources.seed));
  {
    ResultRows rows(plan, resources);
    Sinks sinks = rows.sinks();
    if (resources.verify_cells > 0) sinks.pieces.push_back(std::ref(cells));
    sinks.pieces.insert(sinks.pieces.end(), observers.pieces.begin(), observers.pieces.end());
    sinks.rows.insert(sinks.rows.end(), observers.rows.begin(), observers.rows.end());
    match(distances, plan.match, sinks, last_pass);
    run.result = rows.result();
  }
  timer.end_step("match");

  if (resources.verify_cells > 0) {
    check_cells(cells.result(), plan, monitor);
    run.verified_cells = cells.result().size();
    timer.end_step("verify");
  }
  finish(run, plan, timer, monitor);
  return run;
}

}  // namespace vpr
