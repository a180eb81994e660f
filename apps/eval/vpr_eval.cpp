// vpr-eval: evaluates results of vpr-query, and scores of any method.
#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "eval.h"
#include "evaluate/expectation.h"
#include "evaluate/report.h"
#include "present/evaluation_text.h"
#include "present/methods_table.h"
#include "present/report_tables.h"
#include "present/summary.h"
#include "query/run_info.h"

namespace vpr {
namespace {

constexpr size_t kMostRanges = 3;  // without -v

/// The results, or the scores, with the names of --name or of their files, numbered if equal.
std::vector<EvalRow> eval_rows(const EvalFlags& flags) {
  const auto paths = flags.results.empty() ? std::vector{flags.scores.source()} : flags.results;
  if (!flags.names.empty() && flags.names.size() != paths.size())
    throw Error(ErrorKind::usage,
                "--name is needed for each result, in their order: there are {} results and {}",
                paths.size(), counted(flags.names.size(), "name"));
  std::vector<std::string> names = flags.names;
  if (names.empty()) {
    for (const std::string& path : paths)
      names.push_back(std::filesystem::path(path).stem().string());
    names = numbered_names(names);
  }
  std::vector<EvalRow> rows;
  for (size_t i = 0; i < paths.size(); ++i)
    rows.push_back({flags.results.empty() ? "" : paths[i], flags.matrix, names[i],
                    !flags.names.empty(), flags.results.size() != 1});
  return rows;
}

RunInfo run_of(const Evaluated& evaluated, const EvalFlags& flags, const EvalRow& row,
               RunInfo run) {
  const auto& truth = evaluated.by.ground_truth;
  for (const auto& [role, path] :
       {std::pair("result", row.result),
        std::pair(flags.scores.is_list() ? "predictions" : "scores",
                  flags.scores.path.empty() ? row.matrix : flags.scores.path),
        std::pair("query", flags.scores.query_array),
        std::pair("reference", flags.scores.train_array),
        std::pair("ground_truth", truth ? truth->path.string() : ""),
        std::pair("places", flags.by.places)})
    if (!path.empty()) run.paths[role] = path;
  return run;
}

/// Null without --expect, and if --update creates the file.
Json read_expected(const Session& session, const EvalFlags& flags) {
  if (flags.expected.empty()) return {};
  std::error_code error;
  const bool exists = std::filesystem::exists(flags.expected, error);
  if (!flags.update && !exists)
    throw Error(ErrorKind::input, "{}: no such file. Create it from this report with --update",
                flags.expected);
  if (flags.update && exists) session.outputs.extend(flags.expected);
  if (flags.update) session.outputs.claim_file(flags.expected);
  return exists ? read_json(flags.expected, ErrorKind::usage) : Json();
}

/// Compares the report with the expected values. Writes the updated file.
std::vector<CheckedValue> check_expected(const Session& session, const EvalFlags& flags,
                                         const Json& expected, const Json& report) {
  if (flags.expected.empty()) return {};
  const Json& compared = expected.is_null() ? report : expected;
  std::vector<CheckedValue> values = check_expectations(report, compared, flags.expected);
  if (flags.update)
    session.outputs.file(flags.expected)
        .write(to_text(updated_expectations(report, compared, flags.expected)));
  return values;
}

/// Empty if an error reports the unmet values.
std::string expectation_note(const EvalFlags& flags, size_t values, size_t unmet) {
  if (values == 0 || (unmet > 0 && !flags.update)) return "";
  if (unmet == 0)
    return fmt::format("{}: all of {} met.\n", flags.expected,
                       counted(values, "expected value is", "expected values are"));
  return fmt::format("{}: updated; {} of {} were not met.\n", flags.expected, unmet,
                     counted(values, "expected value"));
}

// vpr-tune with the query, its simulated speed, the database and the ground truth of the run. Empty
// if one of them is unknown or has moved, and if vpr-tune has no flag for a setting of the run.
std::string tuning_command(const Session& session, const EvalFlags& flags,
                           const StoredResult& stored) {
  const std::string database = stored.context.run.path("database");
  const std::string query = stored.context.run.path("query");
  const Selection& selection = stored.result.query.selection;
  const Json settings = settings_in_force(stored.result.settings);
  std::error_code error;
  const bool is_bow = stored.result.places && !stored.context.run.images.contains("query");
  if (settings["loop"] == true || !settings.value("only_sequence", Json()).empty() || is_bow ||
      selection.selected_fps > 0 || !flags.truth.dataset.empty() ||
      !std::filesystem::exists(database, error) ||
      !std::filesystem::exists(parse_sequence_argument(query).path, error))
    return "";
  std::vector<std::string> words = {stored.result.places ? "vpr-tune fabmap" : "vpr-tune",
                                    shell_word(database), "--query " + shell_word(query)};
  if (!selection.speed.empty())
    words.push_back(fmt::format("--speed {} --seed {}", selection.speed, selection.seed));
  if (settings["skip_unreadable"] == true) words.emplace_back("--skip-unreadable");
  std::vector<std::string> repeated = {"--ground-truth", "--tolerance"};
  for (const std::string& flag : session.command.given_flags(kGroundTruthGroup))
    repeated.push_back(flag);
  for (const std::string& flag : repeated)
    for (const std::string& value : session.command.values_of(flag))
      words.push_back(flag + " " + shell_word(value));
  return wrapped_command(words);
}

// Empty if something is recognized, and all of it correctly.
std::string next_step(const Session& session, const EvalFlags& flags, const Evaluated& evaluated) {
  const Evaluation& evaluation = evaluated.evaluation;
  for (const GivenOutput& page : given_outputs(flags))
    if (!page.output->answers.empty())
      return wrapped_text(
          fmt::format("next: open {} in a browser, answer, and pass the file that it saves with {}",
                      page.path, page.output->answers));
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
  const std::string tuning = tuning_command(session, flags, *evaluated.stored);
  if (tuning.empty()) return "";
  return fmt::format("next: compare {} with\n{}\n", has_places ? "settings" : "methods", tuning);
}

/// --pairs of scores without a ground truth.
void run_pairs(Session& session, const EvalFlags& flags, const EvalRow& row) {
  refuse(!session.options.output.empty(), "-o",
         "needs a ground truth. Add --ground-truth or --dataset");
  const auto matrix = open_inputs(session, flags, row).matrix;
  check_rows(flags.scores, matrix->queries, std::nullopt);
  const ScoreLayout layout = layout_of(*matrix, flags.scores.window_length);
  require_fit(*matrix, layout);
  const PairList pairs = pair_list(session, flags, &*matrix, layout, nullptr);
  const std::string& path = flags.output("--pairs");
  session.outputs.file(path).write(pairs.text);
  session.print_result(fmt::format("{}: {}\n", path, counted(pairs.count, "pair")),
                       {{"pairs", pairs.count}});
}

// A sequence that is not needed is a typing error if it does not exist.
void require_sequences(const EvalFlags& flags) {
  std::vector<std::string> named = flags.train;
  if (flags.query && flags.truth.dataset.empty()) named.push_back(*flags.query);
  for (const std::string& text : named)
    if (std::error_code error; !std::filesystem::exists(parse_sequence_argument(text).path, error))
      throw Error(ErrorKind::input, "{}: no such folder, list or video", text);
}

void run_one(Session& session, const EvalFlags& flags, const EvalRow& row) {
  require_sequences(flags);
  std::vector<GivenOutput> given = given_outputs(flags);
  claim_outputs(session, given);
  const Json expected = read_expected(session, flags);
  const auto needs_truth = [](const GivenOutput& one) { return one.output->needs_truth; };
  if (row.needs_truth && !flags.truth.is_given() && flags.expected.empty() && !given.empty() &&
      std::ranges::none_of(given, needs_truth))
    return run_pairs(session, flags, row);
  const Stopwatch watch;
  const Evaluated evaluated = evaluate(session, flags, row);
  const Evaluation& evaluation = evaluated.evaluation;
  EvalRun run{session, flags, constant_rate(flags, evaluated), {}, {}};
  run.summary = summary_sentence(evaluation, run.recorded_fps);
  const Json report =
      report_json(evaluated.report, run_of(evaluated, flags, row, session.run), watch.elapsed_s());
  run.checked = check_expected(session, flags, expected, report);
  session.write_output(report);
  make_outputs(run, evaluated, given);
  write_files(session, given);
  const std::vector<std::string> unmet = unmet_expectations(run.checked);
  const std::string brief = evaluation_text(evaluation, evaluated.report, run.summary,
                                            session.options.verbose ? SIZE_MAX : kMostRanges) +
                            next_step(session, flags, evaluated) +
                            expectation_note(flags, run.checked.size(), unmet.size());
  const std::string tables = evaluation.truth.is_known
                                 ? reports_text({&evaluated.report, 1}, flags.format)
                                 : render_table(places_table(evaluated.report), flags.format);
  session.print_result(output_text(session, flags.format, brief, tables), report);
  if (!unmet.empty() && !flags.update)
    throw Error(ErrorKind::expectation, "{}: not met:\n  {}", flags.expected,
                fmt::join(unmet, "\n  "));
}

void run_several(Session& session, const EvalFlags& flags, const std::vector<EvalRow>& rows) {
  std::vector<GivenOutput> given = given_outputs(flags);
  claim_outputs(session, given);
  const Stopwatch watch;
  const EvalRun run{session, flags, {}, {}, {}};
  RunInfo info = session.run;
  std::vector<Report> reports;
  EvalFlags row_flags = flags;
  for (const EvalRow& row : rows) {
    row_flags.by.warned_as = row.name;
    Evaluated evaluated = evaluate(session, row_flags, row);
    make_outputs(run, evaluated, given);
    reports.push_back(std::move(evaluated.report));
    info.paths[fmt::format("result_{}", reports.size())] = row.result;
  }
  const Json json = reports_json(reports, info, watch.elapsed_s());
  session.write_output(json);
  write_files(session, given);
  const std::string brief = short_text(methods_table(side_by_side(reports), TableDetail::brief));
  session.print_result(
      output_text(session, flags.format, brief, reports_text(reports, flags.format)), json);
}

void run(Session& session, const EvalFlags& flags) {
  const std::vector<EvalRow> rows = eval_rows(flags);
  check_flags(flags);
  if (rows.size() > 1) return run_several(session, flags, rows);
  run_one(session, flags, rows.front());
}

constexpr const char* kExamples =
    "  vpr-eval result.json --ground-truth pairs.csv --html page.html\n"
    "  vpr-eval result.json windows.json --ground-truth aligned --tolerance 3\n"
    "  vpr-eval result.json --dataset dataset.json --expect baseline.json --junit junit.xml";

constexpr const char* kMatrixExamples =
    "  vpr-eval matrix scores.npy --distance --ground-truth pairs.csv\n"
    "  vpr-eval matrix --query tuesday.npy --train monday.npy --recall-at 1,10 "
    "--ground-truth pairs.csv\n"
    "  vpr-eval matrix logs/default/preds --query queries --train database --ground-truth queries "
    "--ground-truth-train database";

void add_matrix(Program& program) {
  const auto flags = std::make_shared<EvalFlags>();
  const Command command =
      program.add_command("matrix", "Evaluate scores or descriptors of any program.",
                          kMatrixExamples, [flags](Session& session) {
                            if (session.options.process.order == FrameOrder::automatic)
                              set_frame_order(FrameOrder::rows);
                            compare_arrays(*flags);
                            run(session, *flags);
                          });
  add_matrix_flags(program, command, *flags);
}

}  // namespace
}  // namespace vpr

int main(int argc, char** argv) {
  using namespace vpr;
  Program program("vpr-eval", "Judge the recognitions of a result of vpr-query by ground truth.",
                  kExamples);
  EvalFlags flags;
  add_result_flags(program, program.command(), flags);
  program.set_run([&](Session& session) { run(session, flags); });
  add_matrix(program);
  add_loops(program);
  add_compare(program);
  add_convert(program);
  add_check(program);
  return program.main(argc, argv);
}
