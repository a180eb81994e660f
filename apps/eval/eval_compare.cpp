#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "eval.h"
#include "evaluate/report.h"
#include "present/comparison_report.h"
#include "present/evaluation_text.h"

namespace vpr {
namespace {

constexpr const char* kMoreGroup = "More options";

struct CompareInputs {
  std::vector<std::string> reports;
  TruthSource truth;  ///< of results
  std::vector<std::string> names;
  uint64_t block = 0;  ///< 0: chosen from the windows
  bool allow_different = false;
  bool only_common = false;
  std::string html;
  std::string plots;
  TableFormat format = TableFormat::text;
};

void warn_about_queries(const Monitor& monitor, const std::vector<std::string>& paths,
                        const std::vector<Report>& reports) {
  for (size_t r = 1; r < reports.size(); ++r) {
    const bool is_unnamed = reports[0].query == kUnnamedQuery || reports[r].query == kUnnamedQuery;
    const bool has_same_truth =
        reports[r].provenance.ground_truth == reports[0].provenance.ground_truth;
    if (reports[r].query != reports[0].query && !is_unnamed && !has_same_truth)
      warn(monitor, "{} evaluates the query {}, but {} evaluates {}", paths[0], reports[0].query,
           paths[r], reports[r].query);
  }
}

void check_ground_truths(const Monitor& monitor, const CompareInputs& inputs,
                         const std::vector<Report>& reports) {
  size_t other = 1;  // the first report with another ground truth
  const auto& first = reports[0].provenance.ground_truth;
  while (other + 1 < reports.size() && reports[other].provenance.ground_truth == first) ++other;
  const std::string words =
      fmt::format("\"{}\" in {}, \"{}\" in {}", reports[0].protocol.ground_truth, inputs.reports[0],
                  reports[other].protocol.ground_truth, inputs.reports[other]);
  switch (compare_ground_truths(reports)) {
    case GroundTruths::same:
      return;
    case GroundTruths::of_places_and_frames:
      warn(monitor,
           "places and frames have different ground truths, and frames with a match in only one of "
           "them are omitted: {}",
           words);
      return;
    case GroundTruths::different:
      if (!inputs.allow_different)
        throw Error(ErrorKind::data,
                    "the reports have different ground truths: {}. Evaluate all results with one "
                    "of them, or add --allow-different",
                    words);
      warn(monitor,
           "the ground truths are different, and frames with a match in only some of them are "
           "omitted: {}",
           words);
  }
}

// The report in a file, or of the result in it.
Report find_report(Session& session, const std::string& path, const TruthSource& truth) {
  const Json json = read_json(path, ErrorKind::data);
  const Json schema = json.is_object() ? json.value("schema", Json()) : Json();
  if (!schema.is_string() || !schema.get<std::string>().starts_with("vpr.result/"))
    return parse_report(json, path);
  if (!truth.is_given())
    throw Error(ErrorKind::usage,
                "{}: is a result. Add --ground-truth or --dataset to evaluate it, or pass its "
                "report (vpr-eval {} -o REPORT)",
                path, path);
  EvalFlags flags;
  flags.truth = truth;
  return evaluate(session, flags, {.result = path}).report;
}

void claim_outputs(const Session& session, const CompareInputs& inputs) {
  if (!inputs.names.empty() && inputs.names.size() != inputs.reports.size())
    throw Error(ErrorKind::usage,
                "--name is needed for each report, in their order: there are {} reports and {}",
                inputs.reports.size(), counted(inputs.names.size(), "name"));
  session.claim_output({inputs.html}, inputs.plots);
}

void run_compare(Session& session, const CompareInputs& inputs) {
  claim_outputs(session, inputs);
  const Stopwatch watch;
  ComparisonReport comparison;
  for (const std::string& path : inputs.reports)
    comparison.reports.push_back(find_report(session, path, inputs.truth));
  for (size_t r = 0; r < inputs.names.size(); ++r) comparison.reports[r].name = inputs.names[r];
  name_rows(comparison.reports, inputs.reports);
  warn_about_queries(session.monitor, inputs.reports, comparison.reports);
  check_ground_truths(session.monitor, inputs, comparison.reports);
  comparison.settings =
      comparison_settings(comparison.reports, inputs.block, session.options.process.seed,
                          inputs.only_common, inputs.allow_different);
  compare_reports(comparison, session.monitor);
  comparison.made_by = provenance_of(session.run);
  Json json = comparison_json(comparison);
  RunInfo info = session.run;
  for (size_t r = 0; r < inputs.reports.size(); ++r)
    info.paths[fmt::format("report_{}", r + 1)] = inputs.reports[r];
  add_run(json, info, {{"compare", watch.elapsed_s()}});
  session.write_output(json);
  if (!inputs.html.empty()) session.outputs.file(inputs.html).write(comparison_page(comparison));
  if (!inputs.plots.empty())
    draw_comparison(comparison, session.outputs.folder(inputs.plots, is_marked_folder).temporary());
  session.print_result(output_text(session, inputs.format, comparison_text(comparison),
                                   comparison_tables(comparison, inputs.format)),
                       json);
}

}  // namespace

void add_compare(Program& program) {
  const auto inputs = std::make_shared<CompareInputs>();
  const Command command = program.add_command(
      "compare", "Compare reports or results of the same queries.",
      "  vpr-eval compare result.json windows.json --ground-truth pairs.csv\n"
      "  vpr-eval compare a.json b.json --name ours --name theirs --format latex\n"
      "  vpr-eval compare a.json b.json c.json --html compared.html --plot plots\n"
      "  vpr-eval compare a.json b.json c.json --block 40 --json > comparison.json",
      [inputs](Session& session) { run_compare(session, *inputs); });
  command
      .add_option("REPORT", inputs->reports,
                  "reports of vpr-eval, or results of vpr-query with a ground truth; the first one "
                  "is the baseline of the others")
      .required()
      .expected(2, 1000);
  add_truth_flags(command, inputs->truth);
  command.add_list("--name", inputs->names,
                   "name of a report in tables; repeat it for all, in their order (default: the "
                   "name in the report, or the name of the file)");
  command.add_option("--html", inputs->html,
                     "HTML page with the tables, and curves and paths of all reports",
                     kEssentialGroup, "FILE");
  command.add_option("--plot", inputs->plots,
                     "folder for curves and paths of all reports, as SVG and PNG", kEssentialGroup,
                     "FOLDER");
  add_setting(command, "--block", inputs->block,
              "consecutive frames that are resampled together, since neighbors depend on each "
              "other (default: the longest window, at least 10)",
              kMoreGroup);
  command.add_flag("--common", inputs->only_common,
                   "compare only frames for which every report has a best match that is correct or "
                   "incorrect; all numbers are then over these frames",
                   kMoreGroup);
  command.add_flag("--allow-different", inputs->allow_different,
                   "compare reports with different ground truths; the output states them",
                   kMoreGroup);
  add_format_flag(command, inputs->format).group(kMoreGroup);
}

}  // namespace vpr
