#include "run/query.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/monitor.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "match/rates.h"
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
                          first.query_window, plan.sequences[first.sequence].name,
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

/// What is found as all rows pass: hits, best matches and their margins, cells to be verified, and
/// what the method filter tells.
struct Found {
  HitScanResult matches;
  std::vector<std::optional<uint32_t>> margins;
  std::vector<Cell> cells;
  std::optional<ResultPath> path;
};

void take_report(Found& found, const PathReport& report, int64_t score_offset) {
  found.margins[report.query_frame] = report.margin;
  found.path->nowhere[report.query_frame] = static_cast<double>(report.nowhere - score_offset);
  if (report.rate) found.path->rates[report.query_frame] = *report.rate;
  found.path->tracks[report.query_frame] = report.track;
}

Found match_rows(const QueryPlan& plan, const SequenceMethod& method,
                 const FrameDistances& distances, MatchSettings match,
                 const QueryResources& resources, const std::vector<RowConsumer>& observers,
                 const Monitor& monitor) {
  Found found;
  if (method.has_paths) {
    found.path.emplace(plan.query_frames);
    found.margins.resize(plan.query_frames);
    match.on_path = [&](const PathReport& report) {
      take_report(found, report, plan.score_offset());
    };
  }
  HitScan scan(scan_settings(plan, resources));
  std::optional<MarginScan> margins;
  if (plan.elsewhere && !method.has_paths)
    margins.emplace(*plan.elsewhere, plan.query_windows, resources.kernels);
  CellScan cells(choose_cells({searched_runs(plan), distances.query_runs}, match.window_length,
                              resources.verify_cells, resources.seed));
  const auto take = [&](const ScoreRow& row) {
    const uint32_t least = resources.kernels.minimum(row.scores.data(), row.scores.size());
    scan.take(row, least);
    if (margins) margins->take(row, least);
    cells(row);
    for (const RowConsumer& observe : observers) observe(row);
  };
  method.match(distances, match, monitor, take);
  found.matches = scan.result();
  if (margins) found.margins = margins->result().margins;
  found.cells = cells.result();
  return found;
}

}  // namespace

QueryRun run_query(QueryPlan plan, const QueryResources& resources,
                   const std::vector<RowConsumer>& observers, const Monitor& monitor) {
  if (resources.verify_cells > 0) check_verification(plan.settings, plan.query.given != nullptr);
  QueryRun run;
  const SequenceMethod& method = find_sequence_method(plan.settings.method);
  MatchSettings match{
      plan.settings.window_length,      resources.memory_limit, resources.kernels, {}, {},
      parse_rates(plan.settings.rates), plan.settings.filter};
  if (plan.elsewhere) match.shared_places = plan.elsewhere->shared;
  const std::optional<ScoreBasis> basis = score_basis(plan.learned, plan.settings);
  FrameDistances distances = searched_distances(plan);
  distances.past = plan.past;
  StepTimer timer(run.seconds);

  // A relative threshold is known only after all distances were seen once.
  const bool has_two_passes = needs_maxima(plan);
  if (has_two_passes) {
    MaximumScan scan(plan.sequences.size(), resources.kernels);
    method.match(distances, match, part_of(monitor, "pass", 0, 2), std::ref(scan));
    set_relative_limits(plan, scan.result());
    timer.end_step("maximum");
  }
  const Monitor last_pass = has_two_passes ? part_of(monitor, "pass", 1, 2) : monitor;
  distances = scored(std::move(distances), basis, plan, last_pass);
  Found found = match_rows(plan, method, distances, match, resources, observers, last_pass);
  run.result = make_result(plan, found.matches, found.margins);
  run.result.path = std::move(found.path);
  timer.end_step("match");

  if (resources.verify_cells > 0) {
    check_cells(found.cells, plan, basis, monitor);
    run.verified_cells = found.cells.size();
    timer.end_step("verify");
  }
  found = {};  // clustering needs the memory
  cluster(run.result, monitor);
  timer.end_step("cluster");
  run.result.views = find_views(plan);
  return run;
}

}  // namespace vpr
