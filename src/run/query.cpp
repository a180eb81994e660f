#include "run/query.h"

#include <functional>

#include <fmt/format.h>

#include "base/error.h"
#include "base/monitor.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "match/lsh.h"
#include "run/verify.h"

namespace vpr {
namespace {

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
std::optional<ResultViews> find_views(const QueryPlan& plan) {
  if (!plan.typical_distance) return std::nullopt;
  ResultViews views{view_starts(plan.query, *plan.typical_distance), {}};
  for (const DescriptorSpan& sequence : plan.train)
    views.train.push_back(view_starts(sequence, *plan.typical_distance));
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

ResultRows::ResultRows(const QueryPlan& plan, const QueryResources& resources)
    : plan_(plan), recognitions_(scan_settings(plan, resources)) {
  if (plan.match.method->has_paths) {
    path_.emplace(plan.query_sequence.frames);
    margins_.resize(plan.query_sequence.frames);
  } else if (plan.elsewhere) {
    scan_.emplace(*plan.elsewhere, plan.query_windows, resources.kernels);
  }
}

Sinks ResultRows::sinks() {
  Sinks sinks{{std::ref(recognitions_)}, {}};
  if (scan_) sinks.rows.push_back(std::ref(*scan_));
  if (path_) sinks.rows.push_back([this](std::span<const ScoreRow> row) { take_path(row); });
  return sinks;
}

void ResultRows::take_path(std::span<const ScoreRow> row) {
  const PathReport& report = *row.front().path;
  const size_t frame = row.front().query_window;
  margins_[frame] = report.margin;
  path_->nowhere[frame] = static_cast<double>(int64_t{report.nowhere} - plan_.score_offset());
  if (report.rate) path_->rates[frame] = *report.rate;
  path_->tracks[frame] = report.track;
}

Result ResultRows::result() {
  if (scan_) margins_ = scan_->result().margins;
  Result result = make_result(plan_, recognitions_.result(), margins_);
  result.path = std::move(path_);
  return result;
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
  CellScan cells(choose_cells({distances.train_runs, distances.query_runs},
                              plan.match.window_length, resources.verify_cells, resources.seed));
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
