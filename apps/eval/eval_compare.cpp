#include <algorithm>

#include <fmt/format.h>

#include "base/json.h"
#include "base/stopwatch.h"
#include "eval_commands.h"
#include "present/comparison_page.h"
#include "present/comparison_report.h"
#include "present/evaluation_report.h"

namespace vpr {
namespace {

constexpr size_t kResamples = 2000;
constexpr size_t kLeastBlock = 10;

size_t block_of(const CompareInputs& inputs, const std::vector<StoredReport>& reports) {
  if (inputs.block > 0) return inputs.block;
  size_t block = kLeastBlock;
  for (const StoredReport& report : reports) block = std::max(block, report.outcomes.window_length);
  return block;
}

void warn_about_queries(const Monitor& monitor, const std::vector<std::string>& paths,
                        const std::vector<StoredReport>& reports) {
  for (size_t r = 1; r < reports.size(); ++r) {
    const bool is_unnamed = reports[0].query == kUnnamedQuery || reports[r].query == kUnnamedQuery;
    if (reports[r].query != reports[0].query && !is_unnamed)
      warn(monitor, fmt::format("{} is of the query {}, {} of {}", paths[0], reports[0].query,
                                paths[r], reports[r].query));
  }
}

/// The first report that is not judged as the first of all is, and how each is, in words.
std::string difference_in_words(const std::vector<std::string>& paths,
                                const std::vector<StoredReport>& reports) {
  size_t r = 1;
  const auto agrees = [&](const StoredReport& report) {
    return report.ground_truth_fingerprint == reports[0].ground_truth_fingerprint;
  };
  while (r + 1 < reports.size() && agrees(reports[r])) ++r;
  return fmt::format("{} is judged by \"{}\", {} by \"{}\"", paths[0], reports[0].ground_truth,
                     paths[r], reports[r].ground_truth);
}

void check_ground_truths(const Monitor& monitor, const CompareInputs& inputs,
                         const std::vector<StoredReport>& reports) {
  const std::string words = difference_in_words(inputs.reports, reports);
  switch (compare_ground_truths(reports)) {
    case GroundTruths::same:
      return;
    case GroundTruths::of_places_and_frames:
      warn(monitor,
           fmt::format("places and frames have ground truths of their own: queries of which "
                       "only one has a match are left out; {}",
                       words));
      return;
    case GroundTruths::different:
      if (!inputs.allow_different)
        throw Error(ErrorKind::data,
                    fmt::format("the reports have different ground truths, so that their numbers "
                                "can't be compared: {}; judge both by one, or give "
                                "--allow-different",
                                words));
      warn(monitor, fmt::format("the ground truths are different: {}", words));
  }
}

/// Reports, with the names of --name.
std::vector<StoredReport> read_reports(const CompareInputs& inputs) {
  std::vector<StoredReport> reports;
  for (const std::string& path : inputs.reports) reports.push_back(read_report(path));
  for (size_t r = 0; r < inputs.names.size(); ++r) reports[r].name = inputs.names[r];
  return reports;
}

void claim_outputs(const Session& session, const CompareInputs& inputs) {
  if (!inputs.names.empty() && inputs.names.size() != inputs.reports.size())
    throw Error(ErrorKind::usage, fmt::format("give --name for each report, in their order: there "
                                              "are {} reports and {} names",
                                              inputs.reports.size(), inputs.names.size()));
  session.claim_output();
  if (!inputs.html.empty()) session.outputs.claim_file(inputs.html);
  if (!inputs.plots.empty()) session.outputs.claim_folder(inputs.plots, is_marked_folder);
}

std::string tables_of(const Json& json, TableFormat format) {
  if (format == TableFormat::csv) return render_table(comparison_rows(json), format);
  std::string text =
      render_table(paper_table(json), format) + "\n" + render_table(comparison_table(json), format);
  if (!json["paired"].empty()) text += "\n" + render_table(paired_table(json), format);
  return text;
}

void run_compare(Session& session, const CompareInputs& inputs) {
  const CommonOptions& options = session.options;
  claim_outputs(session, inputs);
  const Stopwatch watch;
  const std::vector<StoredReport> reports = read_reports(inputs);
  const std::vector<std::string> names = report_names(reports, inputs.reports);
  warn_about_queries(session.monitor, inputs.reports, reports);
  check_ground_truths(session.monitor, inputs, reports);
  std::vector<NamedOutcomes> methods;
  for (size_t r = 0; r < reports.size(); ++r)
    methods.push_back({names[r], reports[r].outcomes, is_same_walk(reports[r], reports.front())});
  const bool may_dispute = inputs.allow_different ||
                           compare_ground_truths(reports) == GroundTruths::of_places_and_frames;
  const Comparison comparison =
      compare_outcomes(methods, block_of(inputs, reports), kResamples, options.seed,
                       session.monitor, may_dispute ? Disputed::leave_out : Disputed::refuse);
  Json json = comparison_json(comparison, reports, names, kResamples, session.run);
  RunInfo info = session.run;
  for (size_t r = 0; r < reports.size(); ++r)
    info.paths[fmt::format("report_{}", r + 1)] = inputs.reports[r];
  json["machine"] = machine_json(info);
  json["timing"] = timing_json({{"compare", watch.elapsed_s()}});
  session.write_output(json);
  if (!inputs.html.empty())
    session.outputs.file(inputs.html).write(comparison_page(json, reports, names));
  if (!inputs.plots.empty())
    draw_comparison(json, reports, names,
                    session.outputs.folder(inputs.plots, is_marked_folder).temporary());
  session.print_result(tables_of(json, inputs.format), json);
}

}  // namespace

void add_compare(Program& program, CompareInputs& inputs) {
  const Command command = program.add_command(
      "compare", "Compare reports of methods on the same queries.",
      "  vpr-eval compare mine.json theirs.json\n"
      "  vpr-eval compare a.json b.json --name ours --name theirs --format latex\n"
      "  vpr-eval compare a.json b.json c.json --html compared.html --plot plots\n"
      "  vpr-eval compare a.json b.json c.json --block 40 --json > comparison.json",
      [&](Session& session) { run_compare(session, inputs); });
  command
      .add_option("REPORT", inputs.reports,
                  "reports of vpr-eval; the first is what the others "
                  "are compared with")
      .required()
      .expected(2, 1000);
  command.add_list("--name", inputs.names,
                   "what tables call a report; repeat it for all, in their order (default: what "
                   "the report is called, its method, or the file's name)");
  command
      .add_option("--html", inputs.html,
                  "write a page with the tables, and curves and paths of all: one file that opens "
                  "anywhere")
      .type_name("FILE");
  command
      .add_option("--plot", inputs.plots,
                  "draw curves and paths of all as SVG and PNG into this folder")
      .type_name("FOLDER");
  add_setting(command, "--block", inputs.block,
              "queries that are drawn together, since neighbours depend on each other (default: "
              "the longest window, at least 10)");
  command.add_flag("--allow-different", inputs.allow_different,
                   "compare reports with different ground truths all the same; the output says so");
  add_setting(command, "--format", inputs.format,
              "of the tables: text, csv (a row for each report and metric), markdown or latex");
}

}  // namespace vpr
