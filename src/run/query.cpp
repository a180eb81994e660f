#include "run/query.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/monitor.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "run/query_steps.h"
#include "run/score_basis.h"
#include "run/verify.h"

namespace vpr {
namespace {

std::vector<Cell> find_wrong(std::span<const Cell> cells, const QueryPlan& plan,
                             const std::optional<ScoreBasis>& basis, const Monitor& monitor) {
  if (cells.empty()) return {};
  const size_t length = plan.settings.window_length;
  if (basis) return wrong_scores(cells, plan.train, plan.query, length, *basis, monitor);
  return wrong_cells(cells, plan.train, plan.query.rows, length, monitor);
}

void check_cells(const std::vector<Cell>& cells, const QueryPlan& plan,
                 const std::optional<ScoreBasis>& basis, const Monitor& monitor) {
  const std::vector<Cell> wrong = find_wrong(cells, plan, basis, monitor);
  if (wrong.empty()) return;
  const Cell& first = wrong.front();
  throw Error(ErrorKind::expectation,
              fmt::format("{}, {}; the first is query window {}, {} window {}, "
                          "which should be {}",
                          counted(cells.size(), "cell"), counted(wrong.size(), "difference"),
                          first.query_window, plan.sequences[first.sequence].sequence.name,
                          first.train_window, first.score));
}

/// How long each step takes, one after the other.
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

}  // namespace

QueryRun run_query(QueryPlan plan, const QueryResources& resources, const Sinks& observers,
                   const Monitor& monitor) {
  QueryRun run;
  const MatchSettings settings = match_settings(plan, resources);
  const std::optional<ScoreBasis> basis = score_basis(plan.learned, plan.settings);
  FrameDistances distances = searched_distances(plan);
  StepTimer timer(run.seconds);

  // A relative threshold is known only after all distances were seen once.
  const bool has_two_passes = needs_maxima(plan);
  if (has_two_passes) {
    MaximumScan scan(plan.sequences.size(), resources.kernels);
    match(distances, settings, {{std::ref(scan)}}, part_of(monitor, "pass", 0, 2));
    set_relative_limits(plan, scan.result());
    timer.end_step("maximum");
  }
  const Monitor last_pass = has_two_passes ? part_of(monitor, "pass", 1, 2) : monitor;
  distances = scored(std::move(distances), basis, plan, last_pass);
  CellScan cells(choose_cells({distances.train_runs, distances.query_runs}, settings.window_length,
                              resources.verify_cells, resources.seed));
  {
    ResultRows rows(plan, resources);
    Sinks sinks = rows.sinks();
    if (resources.verify_cells > 0) sinks.pieces.push_back(std::ref(cells));
    sinks.pieces.insert(sinks.pieces.end(), observers.pieces.begin(), observers.pieces.end());
    sinks.rows.insert(sinks.rows.end(), observers.rows.begin(), observers.rows.end());
    match(distances, settings, sinks, last_pass);
    run.result = rows.result();
  }
  timer.end_step("match");

  if (resources.verify_cells > 0) {
    check_cells(cells.result(), plan, basis, monitor);
    run.verified_cells = cells.result().size();
    timer.end_step("verify");
  }
  cluster(run.result, monitor);
  timer.end_step("cluster");
  run.result.views = find_views(plan);
  return run;
}

}  // namespace vpr
