// vpr-eval: how right are the recognitions of a result, or the scores of any method?
#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/stopwatch.h"
#include "eval_commands.h"
#include "eval_inputs.h"
#include "present/evaluation_tables.h"
#include "present/run_info.h"
#include "truth/presets.h"

namespace vpr {
namespace {

/// What may stand in a configuration file.
struct EvalSettings {
  EvalInputs& inputs;
};

template <class Visitor>
void visit_fields(EvalSettings& settings, Visitor&& visit) {
  visit("tolerance", settings.inputs.flags.tolerance_frames);
  visit("format", settings.inputs.format);
  visit("confidence", settings.inputs.confidence);
}

/// Names of rows: what the user gave with --name, else the files' own names, with a number where
/// two are equal. `given`: empty, or one for each.
std::vector<std::string> row_names(const std::vector<std::string>& given,
                                   const std::vector<std::string>& paths) {
  if (!given.empty()) return given;
  std::vector<std::string> stems;
  for (const std::string& path : paths)
    stems.push_back(std::filesystem::path(path).stem().string());
  std::vector<std::string> names = stems;
  for (size_t i = 0; i < names.size(); ++i)
    if (std::count(stems.begin(), stems.end(), stems[i]) > 1)
      names[i] = fmt::format("{} ({})", stems[i], i + 1);
  return names;
}

/// Of result i alone, or of the scores.
EvalInputs inputs_of(const EvalInputs& inputs, size_t i) {
  const auto& paths = inputs.results.empty() ? std::vector{inputs.scores.source()} : inputs.results;
  EvalInputs one = inputs;
  one.row_name = row_names(inputs.names, paths)[i];
  if (!inputs.results.empty()) one.result = inputs.results[i];
  if (!inputs.names.empty()) one.scores.name = inputs.names[i];
  return one;
}

void check_names(const EvalInputs& inputs) {
  const size_t results = std::max<size_t>(inputs.results.size(), 1);
  if (inputs.names.empty() || inputs.names.size() == results) return;
  throw Error(ErrorKind::usage, fmt::format("give --name for each result, in their order: there "
                                            "are {} results and {} names",
                                            results, inputs.names.size()));
}

/// What the data set says.
std::optional<double> frames_per_second(const EvalInputs& inputs) {
  if (inputs.dataset.empty()) return std::nullopt;
  const double rate = read_dataset(inputs.dataset).frames_per_second;
  return rate > 0 ? std::optional(rate) : std::nullopt;
}

std::string tables(const Evaluated& evaluated, const std::string& summary,
                   const EvalInputs& inputs) {
  const std::string opening = inputs.format == TableFormat::text ? summary + "\n\n" : "";
  if (!evaluated.evaluation.truth.is_known)
    return opening + render_table(unjudged_table(evaluated.report), inputs.format);
  return opening + reports_text({&evaluated.report, 1}, {inputs.row_name}, inputs.format);
}

RunInfo run_of(const Evaluated& evaluated, const EvalInputs& inputs, RunInfo run) {
  const auto& truth = evaluated.by.ground_truth;
  for (const auto& [role, path] :
       {std::pair("result", inputs.result), std::pair("scores", inputs.scores.matrix.path),
        std::pair("query", inputs.scores.query_npy),
        std::pair("reference", inputs.scores.reference_npy),
        std::pair("predictions", inputs.scores.predictions),
        std::pair("ground_truth", truth ? truth->path.string() : "")})
    if (!path.empty()) run.paths[role] = path;
  return run;
}

// Of a thinned query, that of the frames that are kept.
std::optional<double> rate_of_frames(const Evaluation& evaluation, const EvalInputs& inputs) {
  const bool is_thinned = evaluation.query().selection.thinned_fps > 0;
  return is_thinned ? evaluation.query().fps : frames_per_second(inputs);
}

void claim_outputs(const Session& session, const EvalInputs& inputs) {
  session.claim_output();
  check_score_inputs(inputs.scores, !inputs.result.empty());
  check_picture_outputs(session, inputs.pictures);
  check_map_inputs(session, inputs);
  claim_csv_outputs(session, inputs.csv, !inputs.result.empty());
  claim_trajectory(session, inputs);
  check_lists(session, inputs);
}

void run_one(Session& session, const EvalInputs& inputs) {
  claim_outputs(session, inputs);
  const Json expected = read_expected(session, inputs.expect);
  if (only_lists(inputs)) return run_lists(session, inputs);
  const Stopwatch watch;
  const Evaluated evaluated = evaluate(session, inputs);
  const Evaluation& evaluation = evaluated.evaluation;
  const std::string summary = summary_sentence(evaluation.judgment, evaluation.truth.is_known,
                                               rate_of_frames(evaluation, inputs));
  const Json report =
      report_json(evaluated.report, run_of(evaluated, inputs, session.run), watch.elapsed_s());
  const std::vector<CheckedValue> values = check_expected(session, inputs.expect, expected, report);
  session.write_output(report);
  write_pictures(session, inputs, evaluated, summary);
  write_map(session, inputs, evaluated);
  CsvRows rows;
  add_rows(rows, inputs.csv, evaluation, inputs.row_name);
  write_csv_rows(session, inputs.csv, rows);
  write_trajectory(session, inputs, evaluated, frames_per_second(inputs));
  write_pairs(session, inputs, evaluation.matrix ? &*evaluation.matrix : nullptr,
              evaluation.judgment.layout, evaluation.result ? &evaluation.result->result : nullptr);
  std::string text = tables(evaluated, summary, inputs);
  if (inputs.format == TableFormat::text) text += met_sentence(inputs.expect, values);
  session.print_result(text, report);
  require_met(inputs.expect, values);
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

void run_several(Session& session, const EvalInputs& inputs) {
  check_several(inputs);
  session.claim_output();
  claim_csv_outputs(session, inputs.csv, true);
  const Stopwatch watch;
  const std::vector<std::string> names = row_names(inputs.names, inputs.results);
  std::vector<Report> reports;
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
  session.print_result(reports_text(reports, names, inputs.format), json);
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

void run(Session& session, const EvalInputs& inputs) {
  check_names(inputs);
  if (is_given(inputs.loops)) return run_loops(session, inputs);
  if (!inputs.protocols.empty()) return run_protocols(session, inputs);
  if (inputs.results.size() > 1) return run_several(session, inputs);
  run_one(session, inputs_of(inputs, 0));
}

constexpr const char* kExamples =
    "  vpr-eval result.json --ground-truth ground_truth.csv\n"
    "  vpr-eval result.json --ground-truth aligned --tolerance 3 --format markdown\n"
    "  vpr-eval --scores similarities.npy --similarity --ground-truth pairs.csv\n"
    "  vpr-eval --query-npy q.npy --reference-npy db.npy --recall-at 1,10,100 "
    "--ground-truth pairs.csv\n"
    "  vpr-eval --predictions logs/default/preds --query queries --train database "
    "--ground-truth queries --ground-truth-reference database\n"
    "  vpr-eval --scores similarities.npy --similarity --query q.txt --train db.txt "
    "--top-k 20 --pairs pairs.txt\n"
    "  vpr-eval short.json long.json --ground-truth aligned --name \"c_l 10\" "
    "--name \"c_l 20\"\n"
    "  vpr-eval result.json --dataset walks.json --expect baseline.json --junit "
    "junit.xml\n"
    "  vpr-eval result.json --protocol nordland-all\n"
    "  vpr-eval --loops loops.csv --poses trajectory.txt --radius 2 --gap 30s "
    "--similarity --plot loops";

}  // namespace
}  // namespace vpr

int main(int argc, char** argv) {
  using namespace vpr;
  Program program("vpr-eval",
                  "Count correct and incorrect recognitions of a result, or evaluate the scores "
                  "of any method.",
                  kExamples);
  EvalInputs inputs;
  ConvertInputs convert;
  CheckInputs check;
  GridInputs grid;
  const Command app = program.command();
  app.add_option("RESULT", inputs.results,
                 "result of vpr-query; several make one table with a row for each");
  app.add_option("--ground-truth", inputs.ground_truth, ground_truth_help());
  app.add_option("--dataset", inputs.dataset, "data set description that names the ground truth");
  app.add_list("--name", inputs.names,
               "what tables and comparisons call the result or the scores (default: the method, or "
               "the file's name); repeat it for several results, in their order");
  add_expect_options(app, inputs.expect);
  add_score_options(app, inputs.scores);
  add_loop_options(app, inputs.loops);
  add_list_options(app, inputs);
  add_picture_options(app, inputs.pictures);
  add_map_options(app, inputs);
  app.add_option("--protocol", inputs.protocols,
                 "instead of a ground truth: one of these words, several with commas, or "
                 "nordland-all; a row for each");
  add_ground_truth_flags(app, inputs.flags);
  add_csv_options(app, inputs.csv);
  add_trajectory_options(app, inputs);
  EvalSettings settings{inputs};
  program.add_config(app, settings);
  add_setting(app, "--confidence", inputs.confidence,
              "what best matches are accepted by, in curves, metrics, pictures and comparisons: "
              "score, or margin, how much better than the best one elsewhere (default: what the "
              "result decided by); the other is reported next to it");
  add_setting(app, "--stretch", inputs.scores.stretch_frames,
              fmt::format("frames of a stretch of the path, for the recall achievement rate "
                          "(default {})",
                          kRouteStretch));
  add_setting(app, "--format", inputs.format, "of the table: text, csv, markdown or latex");
  app.add_footer(metrics_help());
  CompareInputs compare;
  add_compare(program, compare);
  program.set_run([&](Session& session) { run(session, inputs); });
  add_convert(program, convert);
  add_grid(program, grid);
  add_check(program, check);
  return program.main(argc, argv);
}
