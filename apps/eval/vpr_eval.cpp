// vpr-eval: how right are the recognitions of a result, or the scores of any method?
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/json.h"
#include "base/stopwatch.h"
#include "common/command.h"
#include "common/ground_truth_flags.h"
#include "eval_check.h"
#include "eval_compare.h"
#include "eval_convert.h"
#include "eval_csv.h"
#include "eval_map.h"
#include "eval_pictures.h"
#include "eval_protocols.h"
#include "eval_results.h"
#include "eval_scores.h"
#include "evaluation/counts.h"
#include "evaluation/expectation.h"
#include "ground_truth/dataset.h"
#include "images/sequence_names.h"
#include "report/evaluation_report.h"
#include "report/matrix_file.h"
#include "report/outcome_csv.h"
#include "report/result_file.h"
#include "report/scores_report.h"
#include "report/summary.h"

namespace vpr {
namespace {

struct EvalInputs {
  std::vector<std::string> results;
  std::string result;    ///< the one that is evaluated
  std::string row_name;  ///< what its rows are called
  std::vector<std::string> names;
  std::string ground_truth;
  std::string dataset;
  GroundTruthFlags flags;
  std::string protocols;
  std::string expected;
  TableFormat format = TableFormat::text;
  CsvInputs csv;
  ScoreInputs scores;
  PictureInputs pictures;
  MapInputs map;
};

/// What may stand in a configuration file.
struct EvalSettings {
  EvalInputs& inputs;
};

template <class Visitor>
void visit_fields(EvalSettings& settings, Visitor&& visit) {
  visit("tolerance", settings.inputs.flags.tolerance_frames);
  visit("format", settings.inputs.format);
}

/// Nothing where none is named.
std::optional<GroundTruthArgument> find_ground_truth(const EvalInputs& inputs,
                                                     const std::optional<std::string>& query_name,
                                                     bool is_fabmap) {
  if (!inputs.ground_truth.empty()) return ground_truth_argument(inputs.ground_truth, inputs.flags);
  if (inputs.dataset.empty()) return std::nullopt;
  const Dataset dataset = read_dataset(inputs.dataset);
  const DatasetQuery& query = select_query(dataset, query_name);
  const auto& found = is_fabmap ? query.place_ground_truth : query.sequence_ground_truth;
  if (!found) return std::nullopt;
  return with_flags(*found, inputs.flags);
}

[[noreturn]] void refuse_without_truth(const EvalInputs& inputs) {
  if (!inputs.dataset.empty())
    throw Error(ErrorKind::usage,
                fmt::format("{}: the query has no ground truth; name it there or in --ground-truth",
                            inputs.dataset));
  throw Error(ErrorKind::usage,
              "give the ground truth, as in --ground-truth pairs.csv or --ground-truth aligned; "
              "without one, --html and --plot show a result, and nothing else is written");
}

/// Whether all that is asked for can be had without a ground truth: pictures of a result.
bool only_looks(const Session& session, const EvalInputs& inputs) {
  return !inputs.result.empty() && wants_pictures(inputs.pictures) && inputs.expected.empty() &&
         inputs.map.folder.empty() && session.options.output.empty() && !session.options.json &&
         !inputs.csv.any();
}

/// With the poses that the data set names for the query, where --poses gives none.
ScoreInputs with_poses(const EvalInputs& inputs, const std::string& query_name) {
  ScoreInputs scores = inputs.scores;
  if (scores.poses.empty() && !inputs.dataset.empty())
    scores.poses = select_query(read_dataset(inputs.dataset), query_name).sequence.poses.string();
  return scores;
}

/// Throws Error(data) if the matrix is not the one that was saved with the result.
void check_matrix(const Session& session, const StoredResult& stored, const ScoreMatrix& matrix,
                  const EvalInputs& inputs) {
  if (!stored.matrix_checksum)
    warn(session.monitor,
         fmt::format("{}: names no matrix, as vpr-query --save-matrix makes it do; whether {} is "
                     "its own can't be known",
                     inputs.result, inputs.scores.path));
  else if (matrix.fingerprint(session.monitor) != *stored.matrix_checksum)
    throw Error(ErrorKind::data,
                fmt::format("{}: is not the matrix that {} was written with; run vpr-query again "
                            "with --save-matrix, or evaluate the matrix without the result",
                            inputs.scores.path, inputs.result));
}

Evaluation evaluate(Session& session, const StoredResult& stored, const EvalInputs& inputs) {
  const Result& result = stored.result;
  Evaluation evaluation;
  const auto named = find_ground_truth(inputs, result.query_name, result.places.has_value());
  if (!named && !only_looks(session, inputs)) refuse_without_truth(inputs);
  const GroundTruthScope scope = scope_of(result);
  evaluation.ground_truth = named.value_or(GroundTruthArgument{});
  evaluation.truth =
      named ? read_ground_truth(*named, scope, session.monitor) : unknown_ground_truth(scope);
  if (!inputs.scores.path.empty())
    evaluation.matrix = open_saved_scores(inputs.scores, result.score().missing);
  if (evaluation.matrix && !result.places)
    check_matrix(session, stored, *evaluation.matrix, inputs);
  evaluation.judgement = judge_result(session, with_poses(inputs, result.query_name),
                                      evaluation.matrix, result, evaluation.truth);
  evaluation.report =
      report_json(result, count_recognitions(result, evaluation.truth, session.monitor),
                  count_by_view(result, evaluation.truth, session.monitor), evaluation.judgement,
                  evaluation.truth, stored.fingerprint, session.run, session.monitor);
  if (!inputs.csv.recognitions.empty())
    evaluation.recognitions =
        recognitions_csv(result, evaluation.truth, inputs.row_name, session.monitor);
  return evaluation;
}

/// Of scores: as the data set or the sequence's folder has it.
std::string query_name(const EvalInputs& inputs) {
  if (!inputs.dataset.empty())
    return select_query(read_dataset(inputs.dataset), inputs.pictures.query).sequence.name;
  if (!inputs.pictures.query) return kUnnamedQuery;
  return sequence_names({parse_sequence_argument(*inputs.pictures.query)}).front();
}

Evaluation evaluate_unnamed(Session& session, const EvalInputs& inputs) {
  if (inputs.result.empty() && inputs.scores.path.empty())
    throw Error(ErrorKind::usage,
                "give a result of vpr-query, or --scores of any program; see vpr-eval --help");
  if (inputs.result.empty()) {
    const auto named = find_ground_truth(inputs, inputs.pictures.query, false);
    if (!named) refuse_without_truth(inputs);
    return evaluate_scores(session, inputs.scores, query_name(inputs), *named);
  }
  return evaluate(session, read_result(inputs.result, session.monitor), inputs);
}

Evaluation evaluate(Session& session, const EvalInputs& inputs) {
  Evaluation evaluation = evaluate_unnamed(session, inputs);
  if (!inputs.scores.name.empty()) evaluation.report["name"] = inputs.scores.name;
  return evaluation;
}

/// Of result i alone, or of the scores.
EvalInputs inputs_of(const EvalInputs& inputs, size_t i) {
  const auto& paths = inputs.results.empty() ? std::vector{inputs.scores.path} : inputs.results;
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

/// A row for each of several results.
void run_several(Session& session, const EvalInputs& inputs) {
  const PictureInputs& pictures = inputs.pictures;
  if (!inputs.scores.path.empty() || !inputs.expected.empty() || !pictures.html.empty() ||
      !pictures.plots.empty() || !inputs.map.folder.empty())
    throw Error(ErrorKind::usage,
                "several results make one table; --scores, --expect, --html, --plot and --map take "
                "one result");
  check_score_inputs(inputs.scores, true);
  session.claim_output();
  claim_csv_outputs(session, inputs.csv, true);
  const std::vector<std::string> names = row_names(inputs.names, inputs.results);
  CsvRows rows;
  const SeveralReports reports =
      evaluate_several(session, inputs.results, names, inputs.format, [&](size_t i) {
        const Evaluation evaluation = evaluate(session, inputs_of(inputs, i));
        add_rows(rows, inputs.csv, evaluation, names[i]);
        return evaluation.report;
      });
  session.write_output(reports.json);
  write_csv_rows(session, inputs.csv, rows);
  session.print_result(reports.text, reports.json);
}

/// The counts under each of several protocols.
void run_protocols(Session& session, const EvalInputs& inputs) {
  if (!inputs.ground_truth.empty() || !inputs.dataset.empty() || !inputs.expected.empty())
    throw Error(
        ErrorKind::usage,
        "--protocol stands for a ground truth, and its counts are compared with none: leave "
        "out --ground-truth, --dataset and --expect");
  if (inputs.results.size() != 1 || !inputs.scores.path.empty())
    throw Error(ErrorKind::usage, "--protocol takes one result of vpr-query, and no --scores");
  const PictureInputs& pictures = inputs.pictures;
  if (!pictures.html.empty() || !pictures.plots.empty() || !inputs.map.folder.empty() ||
      inputs.csv.any())
    throw Error(
        ErrorKind::usage,
        "pictures and rows for data frames show one protocol: give it as --ground-truth, as in "
        "--ground-truth nordland-exact");
  check_score_inputs(inputs.scores, true);
  evaluate_protocols(session, inputs.protocols, inputs.results[0], inputs.format,
                     [&](const std::string& protocol) {
                       EvalInputs one = inputs_of(inputs, 0);
                       one.ground_truth = protocol;
                       return evaluate(session, one).report;
                     });
}

/// What the data set says.
std::optional<double> frames_per_second(const EvalInputs& inputs) {
  if (inputs.dataset.empty()) return std::nullopt;
  const double rate = read_dataset(inputs.dataset).frames_per_second;
  return rate > 0 ? std::optional(rate) : std::nullopt;
}

std::string tables(const Evaluation& evaluation, const EvalInputs& inputs) {
  const Json& report = evaluation.report;
  const std::string summary = inputs.format == TableFormat::text ? evaluation.summary + "\n\n" : "";
  if (!evaluation.truth.is_known)
    return summary + render_table(unjudged_table(report), inputs.format);
  return summary + report_text({report}, {inputs.row_name}, inputs.format);
}

void draw_map(Session& session, const EvalInputs& inputs, const Evaluation& evaluation) {
  if (inputs.map.with.empty())
    return write_map(session, inputs.map, inputs.dataset, evaluation, nullptr);
  EvalInputs other = inputs;
  other.result = inputs.map.with;
  other.scores = {};
  const Evaluation second = evaluate(session, other);
  write_map(session, inputs.map, inputs.dataset, evaluation, &second);
}

void run(Session& session, const EvalInputs& all) {
  check_names(all);
  if (!all.protocols.empty()) return run_protocols(session, all);
  if (all.results.size() > 1) return run_several(session, all);
  const EvalInputs inputs = inputs_of(all, 0);
  session.claim_output();
  check_score_inputs(inputs.scores, !inputs.result.empty());
  check_picture_outputs(session, inputs.pictures);
  check_map_inputs(session, inputs.map, inputs.dataset);
  claim_csv_outputs(session, inputs.csv, !inputs.result.empty());
  const Json expected =
      inputs.expected.empty() ? Json() : read_json(inputs.expected, ErrorKind::usage);
  const Stopwatch watch;
  Evaluation evaluation = evaluate(session, inputs);
  evaluation.summary =
      summary_sentence(evaluation.judgement, evaluation.truth.is_known, frames_per_second(inputs));
  Json& report = evaluation.report;
  RunInfo info = session.run;
  for (const auto& [role, path] :
       {std::pair("result", inputs.result), std::pair("scores", inputs.scores.path),
        std::pair("ground_truth", evaluation.ground_truth.path.string())})
    if (!path.empty()) info.paths[role] = path;
  report["machine"] = machine_json(info);
  report["timing"] = timing_json({{"evaluate", watch.elapsed_s()}});
  std::vector<std::string> unmet;
  if (!expected.is_null()) unmet = unmet_expectations(report, expected, inputs.expected);
  session.write_output(report);
  write_pictures(session, inputs.pictures, inputs.dataset, evaluation);
  draw_map(session, inputs, evaluation);
  CsvRows rows;
  add_rows(rows, inputs.csv, evaluation, inputs.row_name);
  write_csv_rows(session, inputs.csv, rows);
  session.print_result(tables(evaluation, inputs), report);
  if (!unmet.empty())
    throw Error(ErrorKind::expectation,
                fmt::format("{}: not met:\n  {}", inputs.expected, fmt::join(unmet, "\n  ")));
}

}  // namespace
}  // namespace vpr

int main(int argc, char** argv) {
  using namespace vpr;
  Program program("vpr-eval",
                  "Count correct and incorrect recognitions of a result, or evaluate the scores "
                  "of any method.",
                  "  vpr-eval result.json --ground-truth ground_truth.csv\n"
                  "  vpr-eval result.json --ground-truth aligned --tolerance 3 --format markdown\n"
                  "  vpr-eval --scores similarities.npy --similarity --ground-truth pairs.csv\n"
                  "  vpr-eval short.json long.json --ground-truth aligned --name \"c_l 10\" "
                  "--name \"c_l 20\"\n"
                  "  vpr-eval result.json --protocol nordland-all");
  EvalInputs inputs;
  ConvertInputs convert;
  CheckInputs check;
  const Command app = program.command();
  app.add_option("RESULT", inputs.results,
                 "result of vpr-query; several make one table with a row for each");
  app.add_option("--ground-truth", inputs.ground_truth, ground_truth_help());
  app.add_option("--dataset", inputs.dataset, "data set description that names the ground truth");
  app.add_list("--name", inputs.names,
               "what tables and comparisons call the result or the scores (default: the method, or "
               "the file's name); repeat it for several results, in their order");
  app.add_option("--expect", inputs.expected,
                 "compare the counts with a vpr.expected/1 file or an earlier report; exit code 5 "
                 "if they differ");
  add_score_options(app, inputs.scores);
  add_picture_options(app, inputs.pictures);
  add_map_options(app, inputs.map);
  app.add_option("--protocol", inputs.protocols,
                 "instead of a ground truth: one of these words, several with commas, or "
                 "nordland-all; a row for each");
  add_ground_truth_flags(app, inputs.flags);
  add_csv_options(app, inputs.csv);
  EvalSettings settings{inputs};
  program.add_config(app, settings);
  add_setting(app, "--format", inputs.format, "of the table: text, csv, markdown or latex");
  app.add_footer(metrics_help());
  CompareInputs compare;
  add_compare(program, compare);
  program.set_run([&](Session& session) { run(session, inputs); });
  add_convert(program, convert);
  add_check(program, check);
  return program.main(argc, argv);
}
