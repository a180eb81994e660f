#include "eval_several.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/stopwatch.h"
#include "present/evaluation_tables.h"
#include "present/metrics_report.h"
#include "truth/presets.h"

namespace vpr {

namespace {

// The first table, with best matches over all frames that have a match: results with windows of
// different lengths are compared by that, as a frame without a window is not right.
Table comparable_table(const Json& report) {
  Table table = report_table(report);
  const Json& best = report["best_match"];
  const uint64_t frames =
      report["localisation"]["frames_with_match"].get<uint64_t>() - best["ignored"].get<uint64_t>();
  table.columns.insert(table.columns.end(), {"of frames", "% of frames"});
  table.rows[0].push_back(std::to_string(frames));
  table.rows[0].push_back(
      frames == 0 ? "-"
                  : fmt::format("{:.1f}", 100 * best["correct"].get<double>() / double(frames)));
  return table;
}

std::vector<Table> tables_of(const Json& report, bool is_one) {
  std::vector<Table> tables = {is_one ? report_table(report) : comparable_table(report)};
  if (report.contains("by_view")) tables.push_back(view_table(report));
  for (Table& more : metrics_tables(report)) tables.push_back(std::move(more));
  return tables;
}

// One row that says of what it is.
Table csv_row(const Json& report) {
  Table table = comparable_table(report);
  if (report.contains("by_view")) {
    const Table views = view_table(report);
    table.columns.insert(table.columns.end(), views.columns.begin(), views.columns.end());
    table.rows[0].insert(table.rows[0].end(), views.rows[0].begin(), views.rows[0].end());
  }
  append_metrics(table, report);
  table.columns.insert(table.columns.begin(), {"method", "query"});
  table.rows[0].insert(table.rows[0].begin(),
                       {report["method"].get<std::string>(), report["query"].get<std::string>()});
  return table;
}

Table csv_table(const std::vector<Json>& reports, const std::vector<std::string>& names) {
  std::vector<Table> rows;
  for (const Json& report : reports) rows.push_back(csv_row(report));
  return stack_tables(rows, "name", names);
}

void check_several(const EvalInputs& inputs) {
  if (inputs.scores.any() || inputs.expect.any() || inputs.shows_one())
    throw Error(
        ErrorKind::usage,
        "--scores, --expect, --html, --plot, --map, --fixes-tum and --pairs take one result. For "
        "a page of several: vpr-eval report FOLDER --html FILE, or vpr-eval compare REPORT "
        "REPORT --html FILE");
  check_score_inputs(inputs.scores, true);
}

void check_protocols(const EvalInputs& inputs) {
  if (!inputs.ground_truth.empty() || !inputs.dataset.empty() || inputs.expect.any())
    throw Error(
        ErrorKind::usage,
        "--protocol stands for a ground truth, and its counts are compared with none: leave "
        "out --ground-truth, --dataset and --expect");
  if (inputs.results.size() != 1 || inputs.scores.any())
    throw Error(ErrorKind::usage, "--protocol takes one result of vpr-query, and no --scores");
  if (inputs.shows_one() || inputs.csv.any())
    throw Error(ErrorKind::usage,
                "pictures, pairs and rows for data frames show one protocol: give it as "
                "--ground-truth, as in "
                "--ground-truth nordland-exact");
  check_score_inputs(inputs.scores, true);
}

}  // namespace

std::string report_text(const std::vector<Json>& reports, const std::vector<std::string>& names,
                        TableFormat format) {
  if (format == TableFormat::csv) return render_table(csv_table(reports, names), format);
  const bool is_one = reports.size() == 1;
  std::vector<std::vector<Table>> kinds;  // tables that are of one kind in all reports
  std::vector<std::vector<std::string>> named;
  for (size_t r = 0; r < reports.size(); ++r) {
    std::vector<Table> tables = tables_of(reports[r], is_one);
    kinds.resize(std::max(kinds.size(), tables.size()));
    named.resize(kinds.size());
    for (size_t t = 0; t < tables.size(); ++t) {
      kinds[t].push_back(std::move(tables[t]));
      named[t].insert(named[t].end(), kinds[t].back().rows.size(), names[r]);
    }
  }
  std::string text;
  for (size_t t = 0; t < kinds.size(); ++t) {
    const Table table = is_one ? kinds[t][0] : stack_tables(kinds[t], "name", named[t]);
    text += (t == 0 ? "" : "\n") + render_table(table, format);
    if (t > 0 || !is_one || format != TableFormat::text) continue;
    const std::string places = recognitions_text(reports[0]);
    if (!places.empty()) text += "\n" + places;
  }
  return text;
}

void run_several(Session& session, const EvalInputs& inputs) {
  check_several(inputs);
  session.claim_output();
  claim_csv_outputs(session, inputs.csv, true);
  const Stopwatch watch;
  const std::vector<std::string> names = row_names(inputs.names, inputs.results);
  std::vector<Json> reports;
  CsvRows rows;
  for (size_t i = 0; i < inputs.results.size(); ++i) {
    Evaluated evaluated = evaluate(session, inputs_of(inputs, i));
    add_rows(rows, inputs.csv, evaluated.evaluation, names[i]);
    reports.push_back(std::move(evaluated.report));
  }
  RunInfo info = session.run;
  for (size_t i = 0; i < inputs.results.size(); ++i)
    info.paths[fmt::format("result_{}", i + 1)] = inputs.results[i];
  const Json json = reports_json(reports, names, info, watch.elapsed_s());
  session.write_output(json);
  write_csv_rows(session, inputs.csv, rows);
  session.print_result(report_text(reports, names, inputs.format), json);
}

void run_protocols(Session& session, const EvalInputs& inputs) {
  check_protocols(inputs);
  session.claim_output();
  const Stopwatch watch;
  std::vector<ProtocolReport> reports;
  for (const GroundTruthPreset* preset : find_presets(inputs.protocols)) {
    EvalInputs one = inputs_of(inputs, 0);
    one.ground_truth = preset->name;
    reports.push_back({preset, evaluate(session, one).report});
  }
  RunInfo info = session.run;
  info.paths = {{"result", inputs.results[0]}};
  const Json json = protocols_json(reports, info, watch.elapsed_s());
  session.write_output(json);
  std::string text = render_table(protocols_table(reports), inputs.format);
  if (inputs.format == TableFormat::text) text += protocols_notes(reports);
  session.print_result(text, json);
}

}  // namespace vpr
