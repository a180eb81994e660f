#include <algorithm>
#include <memory>
#include <tuple>

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

struct CompareInputs {
  std::vector<std::string> reports;
  TruthSource truth;  ///< of results
  std::vector<std::string> names;
  ComparisonSettings settings;
  std::string html;
  std::string plots;
  FigureSettings figure;
  TableFormat format = TableFormat::text;
};

void check_ground_truths(const Monitor& monitor, const CompareInputs& inputs,
                         const ComparisonReport& comparison) {
  const auto& [reports, paths] = std::tie(comparison.reports, comparison.paths);
  if (reports.size() < 2) return;
  size_t other = 1;  // the first report with another ground truth
  const auto& first = reports[0].provenance.ground_truth;
  while (other + 1 < reports.size() && reports[other].provenance.ground_truth == first) ++other;
  const std::string& truth = reports[0].protocol.ground_truth;
  const std::string& other_truth = reports[other].protocol.ground_truth;
  const std::string words = fmt::format(
      "\"{}\" in {}, \"{}\" in {}{}", truth, paths[0], other_truth, paths[other],
      truth == other_truth ? ", of other frames or searched sequences (--only-sequence)" : "");
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
      if (!inputs.settings.omit_disputed)
        throw Error(ErrorKind::data,
                    "the reports have different ground truths: {}. Evaluate all results with one "
                    "of them, name the data set of each with --data-set of vpr-eval, or add "
                    "--allow-different",
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
  flags.by.warned_as = path;
  return evaluate(session, flags, {.result = path}).report;
}

// Columns of recall@K that no table has, because reports lack the ranks.
void warn_about_ranks(const Monitor& monitor, const std::vector<size_t>& recall_at,
                      const std::vector<ComparisonReport>& comparisons) {
  std::vector<size_t> unknown;
  for (const size_t k : recall_at) {
    const auto has_value = [&](const Report& report) {
      return value_of(report, metric_at("recall_at", k)).has_value();
    };
    if (std::ranges::none_of(comparisons, [&](const ComparisonReport& one) {
          return std::ranges::any_of(one.reports, has_value);
        }))
      unknown.push_back(k);
  }
  if (!unknown.empty())
    warn(monitor,
         "recall@K is unknown for K = {}: the reports have shorter lists, or only best matches. "
         "Evaluate results with --matrix",
         fmt::join(unknown, ", "));
}

void run_compare(Session& session, const CompareInputs& inputs) {
  if (!inputs.names.empty() && inputs.names.size() != inputs.reports.size())
    throw Error(ErrorKind::usage,
                "--name is needed for each report, in their order: there are {} reports and {}",
                inputs.reports.size(), counted(inputs.names.size(), "name"));
  session.claim_output({inputs.html}, inputs.plots);
  const Stopwatch watch;
  std::vector<Report> reports;
  for (size_t r = 0; r < inputs.reports.size(); ++r) {
    reports.push_back(find_report(session, inputs.reports[r], inputs.truth));
    if (!inputs.names.empty()) reports.back().name = inputs.names[r];
  }
  std::vector<ComparisonReport> comparisons = by_data_set(std::move(reports), inputs.reports);
  for (ComparisonReport& comparison : comparisons) {
    check_ground_truths(session.monitor, inputs, comparison);
    comparison.settings = inputs.settings;
    comparison.settings.seed = session.options.process.seed;
    compare_reports(comparison, session.monitor);
    comparison.made_by = provenance_of(session.run);
  }
  warn_about_ranks(session.monitor, inputs.settings.recall_at, comparisons);
  Json json = comparisons_json(comparisons);
  RunInfo info = session.run;
  for (size_t r = 0; r < inputs.reports.size(); ++r)
    info.paths[fmt::format("report_{}", r + 1)] = inputs.reports[r];
  add_run(json, info, {{"compare", watch.elapsed_s()}});
  session.write_output(json);
  if (!inputs.html.empty()) session.outputs.file(inputs.html).write(comparison_page(comparisons));
  if (!inputs.plots.empty())
    draw_comparison(comparisons, session.outputs.folder(inputs.plots, is_marked_folder).temporary(),
                    inputs.figure);
  session.print_result(output_text(session, inputs.format, comparison_text(comparisons),
                                   comparison_tables(comparisons, inputs.format)),
                       json);
}

}  // namespace

void add_compare(Program& program) {
  const auto inputs = std::make_shared<CompareInputs>();
  const Command command = program.add_command(
      "compare", "Compare methods by their reports or results, on one or several data sets.",
      "  vpr-eval compare result.json windows.json --ground-truth pairs.csv\n"
      "  vpr-eval compare a.json b.json --name ours --name theirs --format latex\n"
      "  vpr-eval compare */hog.json */gist.json --recall-at 1,5,10 --format latex\n"
      "  vpr-eval compare a.json b.json c.json --html compared.html --plot plots\n"
      "  vpr-eval compare a.json b.json c.json --block 40 --json > comparison.json",
      [inputs](Session& session) { run_compare(session, *inputs); });
  command
      .add_option(
          "REPORT", inputs->reports,
          "reports of vpr-eval, or results of vpr-query with a ground truth: a row per method, "
          "a group of columns per data set; the first report of a data set is the baseline "
          "of the others")
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
                     "folder for curves and paths of all reports, as SVG, PDF and PNG",
                     kEssentialGroup, "FOLDER");
  add_figure_flags(command, inputs->figure, kMoreGroup);
  add_setting(command, "--block", inputs->settings.block,
              "consecutive frames that are resampled together, since neighbors depend on each "
              "other (default: from the autocorrelation of correct best matches)",
              kMoreGroup);
  command
      .add_option("--recall-at", inputs->settings.recall_at,
                  "K of recall@K in tables (default: those of the reports)", kMoreGroup, "K")
      .comma_separated();
  command.add_flag("--common", inputs->settings.only_common,
                   "compare only frames for which every report has a best match that is correct or "
                   "incorrect; all numbers are then over these frames",
                   kMoreGroup);
  command.add_flag("--allow-different", inputs->settings.omit_disputed,
                   "compare reports with different ground truths; the output states them",
                   kMoreGroup);
  add_format_flag(command, inputs->format).group(kMoreGroup);
}

}  // namespace vpr
