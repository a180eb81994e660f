// vpr-eval: evaluates results of vpr-query, and scores of any method.
#include <algorithm>
#include <memory>
#include <tuple>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "eval.h"
#include "evaluate/expectation.h"
#include "files/exports.h"
#include "files/report.h"
#include "files/run_info.h"
#include "present/evaluation_text.h"
#include "present/methods_table.h"
#include "present/report_tables.h"
#include "present/summary.h"

namespace vpr {
namespace {

constexpr size_t kMostRanges = 3;  // without -v

/// The names of rows: those of --name, else the names of the files, numbered if they are equal.
std::vector<std::string> row_names(const EvalInputs& inputs) {
  if (!inputs.names.empty()) return inputs.names;
  const auto paths = inputs.results.empty() ? std::vector{inputs.scores.source()} : inputs.results;
  std::vector<std::string> stems;
  for (const std::string& path : paths)
    stems.push_back(std::filesystem::path(path).stem().string());
  return numbered_names(stems);
}

/// The inputs for result i, or for the scores.
EvalInputs inputs_of(const EvalInputs& inputs, size_t i) {
  EvalInputs one = inputs;
  one.row_name = row_names(inputs)[i];
  if (!inputs.results.empty()) one.result = inputs.results[i];
  one.needs_truth = inputs.results.size() != 1;
  if (!inputs.names.empty()) one.name = inputs.names[i];
  return one;
}

std::optional<double> dataset_fps(const EvalInputs& inputs) {
  if (inputs.truth.dataset.empty()) return std::nullopt;
  const double rate = read_dataset(inputs.truth.dataset).frames_per_second;
  return rate > 0 ? std::optional(rate) : std::nullopt;
}

RunInfo run_of(const Evaluated& evaluated, const EvalInputs& inputs, RunInfo run) {
  const auto& truth = evaluated.by.ground_truth;
  for (const auto& [role, path] :
       {std::pair("result", inputs.result),
        std::pair(inputs.scores.is_list() ? "predictions" : "scores",
                  inputs.scores.path.empty() ? inputs.matrix : inputs.scores.path),
        std::pair("query", inputs.scores.query_npy),
        std::pair("reference", inputs.scores.train_npy),
        std::pair("ground_truth", truth ? truth->path.string() : ""),
        std::pair("places", inputs.by.places)})
    if (!path.empty()) run.paths[role] = path;
  return run;
}

/// The files of --outcomes-csv and --recognitions-csv.
struct CsvTables {
  std::string outcomes = kOutcomesHeader;
  std::string recognitions = kRecognitionsHeader;

  void add(const Evaluation& evaluation, const std::string& name) {
    outcomes += outcomes_csv(evaluation.judgment, name, evaluation.query().name);
    if (evaluation.result) recognitions += recognitions_csv(*evaluation.result, name);
  }
  void write(const Session& session, const EvalInputs& inputs) const {
    for (const auto& [path, text] :
         {std::tie(inputs.outcomes_csv, outcomes), std::tie(inputs.recognitions_csv, recognitions)})
      if (!path.empty()) session.outputs.file(path).write(text);
  }
};

/// Null without --expect, and if --update creates the file.
Json read_expected(const Session& session, const EvalInputs& inputs) {
  if (inputs.expected.empty()) return {};
  std::error_code error;
  const bool exists = std::filesystem::exists(inputs.expected, error);
  if (!inputs.update && !exists)
    throw Error(ErrorKind::input, "{}: no such file. Create it from this report with --update",
                inputs.expected);
  if (inputs.update && exists) session.outputs.extend(inputs.expected);
  if (inputs.update) session.outputs.claim_file(inputs.expected);
  return exists ? read_json(inputs.expected, ErrorKind::usage) : Json();
}

/// Compares the report with the expected values. Writes --junit and the updated file.
std::vector<CheckedValue> check_expected(const Session& session, const EvalInputs& inputs,
                                         const Json& expected, const Json& report) {
  if (inputs.expected.empty()) return {};
  const Json& compared = expected.is_null() ? report : expected;
  std::vector<CheckedValue> values = check_expectations(report, compared, inputs.expected);
  if (!inputs.junit.empty()) {
    const std::string suite = fmt::format("{} on {}", report["method"].get<std::string>(),
                                          report["query"].get<std::string>());
    session.outputs.file(inputs.junit).write(junit_xml(suite, inputs.expected, values));
  }
  if (inputs.update)
    session.outputs.file(inputs.expected)
        .write(to_text(updated_expectations(report, compared, inputs.expected)));
  return values;
}

/// Empty if an error reports the unmet values.
std::string expectation_note(const EvalInputs& inputs, size_t values, size_t unmet) {
  if (values == 0 || (unmet > 0 && !inputs.update)) return "";
  if (unmet == 0)
    return fmt::format("{}: all of {} met.\n", inputs.expected,
                       counted(values, "expected value is", "expected values are"));
  return fmt::format("{}: updated; {} of {} were not met.\n", inputs.expected, unmet,
                     counted(values, "expected value"));
}

// vpr-tune with the query, its simulated speed, the database and the ground truth of the run. Empty
// if one of them is unknown or has moved, and if vpr-tune has no flag for a setting of the run.
std::string tuning_command(const Session& session, const EvalInputs& inputs,
                           const StoredResult& stored) {
  const std::string database = stored.context.run.path("database");
  const std::string query = stored.context.run.path("query");
  const Selection& selection = stored.result.query.selection;
  const Json settings = settings_in_force(stored.result.settings);
  std::error_code error;
  const bool is_bow = stored.result.places && !stored.context.run.frame_names.contains("query");
  if (settings["loop"] == true || !settings.value("only_sequence", Json()).empty() || is_bow ||
      selection.selected_fps > 0 || !inputs.truth.dataset.empty() ||
      !std::filesystem::exists(database, error) ||
      !std::filesystem::exists(parse_sequence_argument(query).path, error))
    return "";
  std::vector<std::string> words = {stored.result.places ? "vpr-tune fabmap" : "vpr-tune",
                                    shell_word(database), "--query " + shell_word(query)};
  if (!selection.speed.empty())
    words.push_back(fmt::format("--speed {} --seed {}", selection.speed, selection.seed));
  if (settings["skip_unreadable"] == true) words.emplace_back("--skip-unreadable");
  std::vector<std::string> flags = {"--ground-truth", "--tolerance"};
  for (const std::string& flag : session.command.given_flags(kGroundTruthGroup))
    flags.push_back(flag);
  for (const std::string& flag : flags)
    for (const std::string& value : session.command.values_of(flag))
      words.push_back(flag + " " + shell_word(value));
  return wrapped_command(words);
}

// Empty if something is recognized, and all of it correctly.
std::string next_step(const Session& session, const EvalInputs& inputs,
                      const Evaluated& evaluated) {
  const Evaluation& evaluation = evaluated.evaluation;
  for (const auto& [page, flag] : {std::pair(inputs.frame_questions, "--ground-truth labels.csv"),
                                   std::pair(inputs.place_questions, "--places places.csv")})
    if (!page.empty())
      return wrapped_text(
          fmt::format("next: open {} in a browser, answer, and pass the file that it saves with {}",
                      page, flag));
  if (evaluated.stored == nullptr || evaluation.warned_of_ground_truth) return "";
  const Localization& path = evaluation.judgment.localization;
  const bool has_places = evaluated.stored->result.places.has_value();
  if (evaluation.judgment.by == JudgedBy::nothing)
    return path.recognized > 0 && !has_places
               ? "next: judge each place by its images with --ask-places PAGE.html\n"
               : "";
  if (!evaluation.truth.is_known || !evaluation.truth.asked.empty() ||
      (path.correct > 0 && path.incorrect == 0))
    return "";
  const std::string tuning = tuning_command(session, inputs, *evaluated.stored);
  if (tuning.empty()) return "";
  return fmt::format("next: compare {} with\n{}\n", has_places ? "settings" : "methods", tuning);
}

/// Writes --pairs of scores without a ground truth.
void run_pairs(Session& session, const EvalInputs& inputs) {
  refuse(!session.options.output.empty(), "-o",
         "needs a ground truth. Add --ground-truth or --dataset");
  const auto matrix = open_inputs(session, inputs).matrix;
  check_rows(inputs.scores, matrix->queries, std::nullopt);
  const ScoreLayout layout = layout_of(*matrix, inputs.scores.window_length);
  require_fit(*matrix, layout);
  const size_t count = write_pairs(session, inputs, &*matrix, layout, nullptr);
  session.print_result(fmt::format("{}: {}\n", inputs.pairs, counted(count, "pair")),
                       {{"pairs", count}});
}

// A sequence that is not needed is a typing error if it does not exist.
void require_sequences(const EvalInputs& inputs) {
  std::vector<std::string> named = inputs.train;
  if (inputs.query && inputs.truth.dataset.empty()) named.push_back(*inputs.query);
  for (const std::string& text : named)
    if (std::error_code error; !std::filesystem::exists(parse_sequence_argument(text).path, error))
      throw Error(ErrorKind::input, "{}: no such folder, list or video", text);
}

void run_one(Session& session, const EvalInputs& inputs) {
  require_sequences(inputs);
  claim_outputs(session, inputs);
  const Json expected = read_expected(session, inputs);
  if (!inputs.pairs.empty() && !inputs.truth.is_given() && !inputs.has_plots() &&
      inputs.expected.empty() && inputs.needs_truth && !inputs.has_csv())
    return run_pairs(session, inputs);
  const Stopwatch watch;
  const Evaluated evaluated = evaluate(session, inputs);
  const Evaluation& evaluation = evaluated.evaluation;
  const std::string summary = summary_sentence(evaluation, dataset_fps(inputs));
  const Json report =
      report_json(evaluated.report, run_of(evaluated, inputs, session.run), watch.elapsed_s());
  const std::vector<CheckedValue> values = check_expected(session, inputs, expected, report);
  session.write_output(report);
  write_plots(session, inputs, evaluated, summary);
  write_map(session, inputs, evaluated);
  write_questions(session, inputs, evaluated);
  CsvTables csv;
  if (inputs.has_csv()) csv.add(evaluation, inputs.row_name);
  csv.write(session, inputs);
  write_trajectory(session, inputs, evaluated, dataset_fps(inputs));
  write_pairs(session, inputs, evaluation.matrix ? &*evaluation.matrix : nullptr,
              evaluation.judgment.layout,
              evaluation.result ? evaluation.result->result.get() : nullptr);
  const std::vector<std::string> unmet = unmet_expectations(values);
  const std::string brief = evaluation_text(evaluation, evaluated.report, summary,
                                            session.options.verbose ? SIZE_MAX : kMostRanges) +
                            next_step(session, inputs, evaluated) +
                            expectation_note(inputs, values.size(), unmet.size());
  const std::string tables = evaluation.truth.is_known
                                 ? reports_text({&evaluated.report, 1}, inputs.format)
                                 : render_table(places_table(evaluated.report), inputs.format);
  session.print_result(output_text(session, inputs.format, brief, tables), report);
  if (!unmet.empty() && !inputs.update)
    throw Error(ErrorKind::expectation, "{}: not met:\n  {}", inputs.expected,
                fmt::join(unmet, "\n  "));
}

/// Whether an output shows a single result.
bool shows_one(const EvalInputs& inputs) {
  return inputs.has_plots() || !inputs.map.empty() || !inputs.saved_trajectory.empty() ||
         !inputs.pairs.empty() || inputs.top_k || !inputs.by.places.empty() ||
         !inputs.place_questions.empty() || !inputs.frame_questions.empty();
}

/// Evaluates and prints several results, one per row.
void run_several(Session& session, const EvalInputs& inputs) {
  if (!inputs.matrix.empty() || inputs.has_expectation() || shows_one(inputs))
    throw Error(ErrorKind::usage,
                "--matrix, --expect, --html, --plot, --map, --save-trajectory, --pairs, --places, "
                "--ask-frames and --ask-places take one result. For a page of several, use "
                "vpr-eval compare --html FILE");
  check_inputs(inputs);
  session.claim_output({inputs.outcomes_csv, inputs.recognitions_csv});
  const Stopwatch watch;
  RunInfo info = session.run;
  std::vector<Report> reports;
  CsvTables csv;
  for (size_t i = 0; i < inputs.results.size(); ++i) {
    const EvalInputs row = inputs_of(inputs, i);
    Evaluated evaluated = evaluate(session, row);
    if (inputs.has_csv()) csv.add(evaluated.evaluation, row.row_name);
    reports.push_back(std::move(evaluated.report));
    info.paths[fmt::format("result_{}", i + 1)] = inputs.results[i];
  }
  const Json json = reports_json(reports, info, watch.elapsed_s());
  session.write_output(json);
  csv.write(session, inputs);
  const std::string brief = short_text(methods_table(side_by_side(reports), TableDetail::brief));
  session.print_result(
      output_text(session, inputs.format, brief, reports_text(reports, inputs.format)), json);
}

void run(Session& session, const EvalInputs& inputs) {
  const size_t results = std::max<size_t>(inputs.results.size(), 1);
  if (!inputs.names.empty() && inputs.names.size() != results)
    throw Error(ErrorKind::usage,
                "--name is needed for each result, in their order: there are {} results and {}",
                results, counted(inputs.names.size(), "name"));
  if (inputs.results.size() > 1) return run_several(session, inputs);
  run_one(session, inputs_of(inputs, 0));
}

constexpr const char* kExamples =
    "  vpr-eval result.json --ground-truth pairs.csv --html page.html\n"
    "  vpr-eval result.json windows.json --ground-truth aligned --tolerance 3\n"
    "  vpr-eval result.json --dataset dataset.json --expect baseline.json --junit junit.xml";

constexpr const char* kMatrixExamples =
    "  vpr-eval matrix scores.npy --distance --ground-truth pairs.csv\n"
    "  vpr-eval matrix --query-npy tuesday.npy --train-npy monday.npy --recall-at 1,10 "
    "--ground-truth pairs.csv\n"
    "  vpr-eval matrix logs/default/preds --query queries --train database --ground-truth queries "
    "--ground-truth-train database";

void add_matrix(Program& program) {
  const auto inputs = std::make_shared<EvalInputs>();
  const Command command =
      program.add_command("matrix", "Evaluate scores or descriptors of any program.",
                          kMatrixExamples, [inputs](Session& session) {
                            if (session.options.process.order == FrameOrder::automatic)
                              set_frame_order(FrameOrder::rows);
                            run(session, *inputs);
                          });
  add_matrix_flags(program, command, *inputs);
}

}  // namespace
}  // namespace vpr

int main(int argc, char** argv) {
  using namespace vpr;
  Program program("vpr-eval", "Judge the recognitions of a result of vpr-query by ground truth.",
                  kExamples);
  EvalInputs inputs;
  add_result_flags(program, program.command(), inputs);
  program.set_run([&](Session& session) { run(session, inputs); });
  add_matrix(program);
  add_loops(program);
  add_compare(program);
  add_convert(program);
  add_check(program);
  return program.main(argc, argv);
}
