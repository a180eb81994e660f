// vpr-eval: how many recognitions of a result are right?
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/stopwatch.h"
#include "command.h"
#include "eval_check.h"
#include "eval_convert.h"
#include "eval_protocols.h"
#include "evaluation/counts.h"
#include "evaluation/expectation.h"
#include "ground_truth_flags.h"
#include "images/dataset.h"
#include "report/evaluation_report.h"
#include "report/fabmap_result_file.h"
#include "report/result_file.h"

namespace vpr {
namespace {

struct EvalInputs {
  std::string result;
  std::string ground_truth;
  std::string dataset;
  int tolerance_frames = -1;  ///< below 0: the data set's, or 0
  GroundTruthFlags flags;
  std::string protocols;
  std::string expected;
  TableFormat format = TableFormat::text;
};

/// What may stand in a configuration file.
struct EvalSettings {
  EvalInputs& inputs;
};

template <class Visitor>
void visit_fields(EvalSettings& settings, Visitor&& visit) {
  visit("tolerance", settings.inputs.tolerance_frames);
  visit("format", settings.inputs.format);
}

GroundTruthArgument find_ground_truth(const EvalInputs& inputs, const std::string& query_name,
                                      bool is_fabmap) {
  const int given = inputs.tolerance_frames;
  if (!inputs.ground_truth.empty())
    return with_flags(parse_ground_truth_argument(inputs.ground_truth, std::max(given, 0)),
                      inputs.flags);
  if (inputs.dataset.empty())
    throw Error(ErrorKind::usage,
                "give the ground truth, as in --ground-truth pairs.csv or --ground-truth aligned");
  const Dataset dataset = read_dataset(inputs.dataset);
  const DatasetQuery& query = select_query(dataset, query_name);
  const auto& found = is_fabmap ? query.place_ground_truth : query.sequence_ground_truth;
  if (!found)
    throw Error(ErrorKind::usage,
                fmt::format("{}: the query {} has no ground truth", inputs.dataset, query_name));
  GroundTruthArgument argument = *found;
  if (given >= 0) argument.tolerance_frames = given;
  return with_flags(argument, inputs.flags);
}

/// A report without "machine" and "timing", and the ground truth that it used.
struct Evaluation {
  Json report;
  GroundTruthArgument ground_truth;
};

template <class Stored>
Evaluation evaluate(const Stored& stored, const EvalInputs& inputs, const RunInfo& run) {
  constexpr bool kIsFabmap = std::is_same_v<Stored, StoredFabmapResult>;
  Evaluation evaluation;
  evaluation.ground_truth = find_ground_truth(inputs, stored.result.query_name, kIsFabmap);
  const GroundTruth truth = read_ground_truth(evaluation.ground_truth, scope_of(stored.result));
  evaluation.report = report_json(stored.result, count_recognitions(stored.result, truth), truth,
                                  stored.fingerprint, run);
  return evaluation;
}

Evaluation evaluate(const EvalInputs& inputs, const RunInfo& run) {
  return result_method(inputs.result) == "fabmap"
             ? evaluate(read_fabmap_result(inputs.result), inputs, run)
             : evaluate(read_result(inputs.result), inputs, run);
}

/// The counts under each of several protocols.
void run_protocols(Session& session, const EvalInputs& inputs) {
  if (!inputs.ground_truth.empty() || !inputs.dataset.empty() || !inputs.expected.empty())
    throw Error(
        ErrorKind::usage,
        "--protocol stands for a ground truth, and its counts are compared with none: leave "
        "out --ground-truth, --dataset and --expect");
  evaluate_protocols(session, inputs.protocols, inputs.result, inputs.format,
                     [&](const std::string& protocol) {
                       EvalInputs one = inputs;
                       one.ground_truth = protocol;
                       return evaluate(one, session.run).report;
                     });
}

void run(Session& session, const EvalInputs& inputs) {
  const CommonOptions& options = session.options;
  if (inputs.result.empty())
    throw Error(ErrorKind::usage, "give a result of vpr-query; see vpr-eval --help");
  if (!inputs.protocols.empty()) return run_protocols(session, inputs);
  if (!options.output.empty()) check_output_file(options.output, options.existing());
  const Json expected =
      inputs.expected.empty() ? Json() : read_json(inputs.expected, ErrorKind::usage);
  const Stopwatch watch;
  auto [report, ground_truth] = evaluate(inputs, session.run);
  RunInfo info = session.run;
  info.paths = {{"result", inputs.result}};
  if (!ground_truth.path.empty()) info.paths["ground_truth"] = ground_truth.path.string();
  report["machine"] = machine_json(info);
  report["timing"] = timing_json({{"evaluate", watch.elapsed_s()}});
  std::vector<std::string> unmet;
  if (!expected.is_null()) unmet = unmet_expectations(report, expected, inputs.expected);
  if (!options.output.empty()) write_file(options.output, to_text(report), options.existing());
  session.print_result(render_table(report_table(report), inputs.format), report);
  if (!unmet.empty())
    throw Error(ErrorKind::expectation,
                fmt::format("{}: not met:\n  {}", inputs.expected, fmt::join(unmet, "\n  ")));
}

}  // namespace
}  // namespace vpr

int main(int argc, char** argv) {
  using namespace vpr;
  Program program("vpr-eval", "Count correct and incorrect recognitions of a result.",
                  "  vpr-eval result.json --ground-truth ground_truth.csv\n"
                  "  vpr-eval result.json --ground-truth aligned --tolerance 3 --format markdown\n"
                  "  vpr-eval result.json --protocol nordland-all");
  EvalInputs inputs;
  ConvertInputs convert;
  CheckInputs check;
  CLI::App& app = program.app();
  app.add_option("RESULT", inputs.result, "result of vpr-query");
  app.add_option("--ground-truth", inputs.ground_truth, ground_truth_help());
  app.add_option("--dataset", inputs.dataset, "data set description that names the ground truth");
  add_setting(app, "--tolerance", inputs.tolerance_frames,
              "of the ground truth, in frames (default: the data set's, or 0)")
      ->check(CLI::NonNegativeNumber);
  app.add_option("--expect", inputs.expected,
                 "compare the counts with a vpr.expected/1 file or an earlier report; exit code 5 "
                 "if they differ");
  app.add_option("--protocol", inputs.protocols,
                 "instead of a ground truth: one of these words, several with commas, or "
                 "nordland-all; a row for each");
  add_ground_truth_flags(app, inputs.flags);
  EvalSettings settings{inputs};
  program.add_config(app, settings);
  add_setting(app, "--format", inputs.format, "of the table: text, csv, markdown or latex");
  program.set_run([&](Session& session) { run(session, inputs); });
  add_convert(program, convert);
  add_check(program, check);
  return program.main(argc, argv);
}
