#include "eval_several.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/stopwatch.h"
#include "eval_results.h"
#include "ground_truth/presets.h"
#include "report/evaluation_report.h"
#include "report/several_reports.h"

namespace vpr {
namespace {

void check_several(const EvalInputs& inputs) {
  const PictureInputs& pictures = inputs.pictures;
  if (inputs.scores.any() || inputs.expect.any() || !pictures.html.empty() ||
      !pictures.plots.empty() || !inputs.map.folder.empty() || !inputs.trajectory.file.empty() ||
      inputs.pairs.any())
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
  const PictureInputs& pictures = inputs.pictures;
  if (!pictures.html.empty() || !pictures.plots.empty() || !inputs.map.folder.empty() ||
      inputs.csv.any() || !inputs.trajectory.file.empty() || inputs.pairs.any())
    throw Error(ErrorKind::usage,
                "pictures, pairs and rows for data frames show one protocol: give it as "
                "--ground-truth, as in "
                "--ground-truth nordland-exact");
  check_score_inputs(inputs.scores, true);
}

}  // namespace

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
