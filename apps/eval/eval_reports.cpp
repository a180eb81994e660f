#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "eval_commands.h"
#include "eval_inputs.h"
#include "present/comparison_report.h"
#include "present/evaluation_report.h"
#include "present/grid_report.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr size_t kResamples = 2000;
constexpr size_t kLeastBlock = 10;

size_t block_of(const CompareInputs& inputs, const std::vector<Report>& reports) {
  if (inputs.block > 0) return inputs.block;
  size_t block = kLeastBlock;
  for (const Report& report : reports) block = std::max(block, report.outcomes.window_length);
  return block;
}

void warn_about_queries(const Monitor& monitor, const std::vector<std::string>& paths,
                        const std::vector<Report>& reports) {
  for (size_t r = 1; r < reports.size(); ++r) {
    const bool is_unnamed = reports[0].query == kUnnamedQuery || reports[r].query == kUnnamedQuery;
    if (reports[r].query != reports[0].query && !is_unnamed)
      warn(monitor, fmt::format("{} is of the query {}, {} of {}", paths[0], reports[0].query,
                                paths[r], reports[r].query));
  }
}

/// The first report that is not judged as the first of all is, and how each is, in words.
std::string difference_in_words(const std::vector<std::string>& paths,
                                const std::vector<Report>& reports) {
  size_t r = 1;
  const auto agrees = [&](const Report& report) {
    return report.provenance.ground_truth == reports[0].provenance.ground_truth;
  };
  while (r + 1 < reports.size() && agrees(reports[r])) ++r;
  return fmt::format("{} is judged by \"{}\", {} by \"{}\"", paths[0],
                     reports[0].protocol.ground_truth, paths[r], reports[r].protocol.ground_truth);
}

void check_ground_truths(const Monitor& monitor, const CompareInputs& inputs,
                         const std::vector<Report>& reports) {
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
std::vector<Report> read_reports(const CompareInputs& inputs) {
  std::vector<Report> reports;
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

std::string tables_of(const ComparisonReport& comparison, TableFormat format) {
  if (format == TableFormat::csv) return render_table(comparison_rows(comparison), format);
  std::string text = render_table(paper_table(comparison), format) + "\n" +
                     render_table(comparison_table(comparison), format);
  const Table paired = paired_table(comparison);
  if (!paired.rows.empty()) text += "\n" + render_table(paired, format);
  return text;
}

Comparison compare(const Session& session, const CompareInputs& inputs,
                   const ComparisonReport& comparison) {
  std::vector<NamedOutcomes> methods;
  for (size_t r = 0; r < comparison.reports.size(); ++r)
    methods.push_back(
        {comparison.names[r], comparison.reports[r].outcomes, comparison.is_paired(r)});
  const bool may_dispute = inputs.allow_different || compare_ground_truths(comparison.reports) ==
                                                         GroundTruths::of_places_and_frames;
  return compare_outcomes(methods, block_of(inputs, comparison.reports), kResamples,
                          session.options.seed, session.monitor,
                          may_dispute ? Disputed::leave_out : Disputed::refuse);
}

void run_compare(Session& session, const CompareInputs& inputs) {
  claim_outputs(session, inputs);
  const Stopwatch watch;
  ComparisonReport comparison;
  comparison.reports = read_reports(inputs);
  comparison.names = report_names(comparison.reports, inputs.reports);
  warn_about_queries(session.monitor, inputs.reports, comparison.reports);
  check_ground_truths(session.monitor, inputs, comparison.reports);
  comparison.found = compare(session, inputs, comparison);
  comparison.resamples = kResamples;
  comparison.made_by = provenance_of(session.run);
  Json json = comparison_json(comparison);
  RunInfo info = session.run;
  for (size_t r = 0; r < inputs.reports.size(); ++r)
    info.paths[fmt::format("report_{}", r + 1)] = inputs.reports[r];
  json["machine"] = machine_json(info);
  json["timing"] = timing_json({{"compare", watch.elapsed_s()}});
  session.write_output(json);
  if (!inputs.html.empty()) session.outputs.file(inputs.html).write(comparison_page(comparison));
  if (!inputs.plots.empty())
    draw_comparison(comparison, session.outputs.folder(inputs.plots, is_marked_folder).temporary());
  session.print_result(tables_of(comparison, inputs.format), json);
}

/// What a folder holds, by schema.
struct FolderContent {
  std::vector<std::string> results;
  std::vector<std::pair<std::string, Report>> reports;
};

/// JSON files of the folder and of those in it, databases left out, in natural order.
std::vector<std::string> json_files(const std::string& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error))
    throw Error(ErrorKind::input, fmt::format("{}: is no folder", folder));
  std::vector<std::string> files;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->is_directory() && entry->path().extension() == ".vprdb")
      entry.disable_recursion_pending();
    else if (entry->is_regular_file() && entry->path().extension() == ".json")
      files.push_back(entry->path().string());
  }
  if (error) throw Error(ErrorKind::input, fmt::format("{}: {}", folder, error.message()));
  std::sort(files.begin(), files.end(), natural_less);
  return files;
}

FolderContent read_folder(const std::string& folder) {
  FolderContent content;
  for (const std::string& path : json_files(folder)) {
    const Json json = read_json(path, ErrorKind::data);
    const std::string schema =
        json.is_object() && json.contains("schema") && json["schema"].is_string()
            ? json["schema"].get<std::string>()
            : "";
    if (schema.starts_with("vpr.result/")) content.results.push_back(path);
    if (schema.starts_with("vpr.report/"))
      content.reports.emplace_back(path, parse_report(json, path));
  }
  return content;
}

/// Throws Error(usage) where an output would replace what is read. A table that an earlier run
/// wrote into the folder may be replaced.
void protect(const Session& session, const FolderContent& content) {
  for (const auto& [path, report] : content.reports) session.outputs.protect(path);
  for (const std::string& path : content.results) {
    session.outputs.protect(path);
    for (const char* kind : kResultArrays) session.outputs.protect(companion_path(path, kind));
  }
}

/// Fills the grid; which file has which cell is kept for messages.
class Grid {
 public:
  void add(const std::string& path, Report report) {
    const std::string method = grid_name(report);
    const auto [found, is_new] = paths_.insert({{method, report.query}, path});
    if (!is_new)
      throw Error(ErrorKind::usage,
                  fmt::format("{} and {} are both of {} on {}; tell them apart by vpr-eval --name, "
                              "or leave one out",
                              found->second, path, method, report.query));
    fingerprints_.insert(report.provenance.evaluated());
    reports.push_back({method, std::move(report)});
  }
  bool has(const std::string& fingerprint) const { return fingerprints_.contains(fingerprint); }

  std::vector<GridReport> reports;

 private:
  std::map<std::pair<std::string, std::string>, std::string> paths_;
  std::set<std::string> fingerprints_;
};

Grid fill(Session& session, const GridInputs& inputs) {
  FolderContent content = read_folder(inputs.folder);
  protect(session, content);
  Grid grid;
  for (auto& [path, report] : content.reports) grid.add(path, std::move(report));
  const bool can_judge = !inputs.dataset.empty() || !inputs.ground_truth.empty();
  size_t unjudged = 0;
  for (const std::string& path : content.results) {
    if (!can_judge) {
      ++unjudged;
      continue;
    }
    EvalInputs one;
    one.result = path;
    one.dataset = inputs.dataset;
    one.ground_truth = inputs.ground_truth;
    one.flags = inputs.flags;
    Evaluated evaluated = evaluate(session, one);
    if (!grid.has(evaluated.evaluation.fingerprint)) grid.add(path, std::move(evaluated.report));
  }
  if (grid.reports.empty())
    throw Error(ErrorKind::input,
                fmt::format("{}: has no reports of vpr-eval{}", inputs.folder,
                            unjudged > 0 ? fmt::format(" and {}; give --dataset or --ground-truth "
                                                       "to have them judged",
                                                       counted(unjudged, "result"))
                                         : ""));
  if (unjudged > 0 && unjudged > grid.reports.size())
    warn(session.monitor,
         fmt::format("{}: has {} that no report is of, maybe; --dataset or --ground-truth judges "
                     "them, too",
                     inputs.folder, counted(unjudged - grid.reports.size(), "result")));
  return grid;
}

void run_grid(Session& session, const GridInputs& inputs) {
  session.claim_output();
  if (!inputs.html.empty()) session.outputs.claim_file(inputs.html);
  const Stopwatch watch;
  const Grid grid = fill(session, inputs);
  std::vector<Report> reports;
  std::vector<std::string> names;
  for (const auto& [method, report] : grid.reports) {
    reports.push_back(report);
    names.push_back(method);
  }
  const Json json = reports_json(reports, names, session.run, watch.elapsed_s());
  session.write_output(json);
  const std::string title = inputs.dataset.empty()
                                ? fs::path(inputs.folder).lexically_normal().filename().string()
                                : read_dataset(inputs.dataset).name;
  if (!inputs.html.empty()) session.outputs.file(inputs.html).write(grid_page(title, grid.reports));
  std::string text;
  if (inputs.format == TableFormat::csv)
    text = render_table(grid_rows(grid.reports), inputs.format);
  else
    for (const Table& table : grid_tables(grid.reports))
      text += (text.empty() ? "" : "\n") + render_table(table, inputs.format);
  session.print_result(text, json);
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
              "queries that are drawn together, since neighbors depend on each other (default: "
              "the longest window, at least 10)");
  command.add_flag("--allow-different", inputs.allow_different,
                   "compare reports with different ground truths all the same; the output says so");
  add_setting(command, "--format", inputs.format,
              "of the tables: text, csv (a row for each report and metric), markdown or latex");
}

void add_grid(Program& program, GridInputs& inputs) {
  const Command command = program.add_command(
      "report", "All reports of a folder, methods and queries, as one table and one page.",
      "  vpr-eval report results --dataset walks.json --html walks.html\n"
      "  vpr-eval report reports --format latex",
      [&](Session& session) { run_grid(session, inputs); });
  command
      .add_option("FOLDER", inputs.folder,
                  "folder with reports of vpr-eval, or with results of vpr-query, in it or in "
                  "folders in it")
      .required();
  command.add_option("--dataset", inputs.dataset,
                     "data set description whose ground truth results are judged by");
  command.add_option("--ground-truth", inputs.ground_truth, ground_truth_help());
  command
      .add_option("--html", inputs.html,
                  "write a page: tables, and for each query curves and paths of all methods")
      .type_name("FILE");
  add_ground_truth_flags(command, inputs.flags);
  add_setting(command, "--format", inputs.format,
              "of the tables: text, csv (a row for each report and metric), markdown or latex");
}

}  // namespace vpr
