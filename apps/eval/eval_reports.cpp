#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "eval.h"
#include "files/report.h"
#include "present/comparison_report.h"
#include "present/evaluation_text.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr size_t kResamples = 2000;
constexpr size_t kMinBlock = 10;
constexpr const char* kMoreGroup = "More options";
constexpr const char* kFormatHelp =
    "format of the tables: text, csv (one row per report and metric), markdown or latex (default: "
    "text)";

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

struct ReportInputs {
  std::string folder;
  TruthSource truth;
  std::string html;
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

std::string schema_of(const Json& json) {
  const Json schema = json.is_object() ? json.value("schema", Json()) : Json();
  return schema.is_string() ? schema.get<std::string>() : "";
}

bool is_result(const std::string& schema) { return schema.starts_with("vpr.result/"); }

Evaluated evaluate_by(Session& session, const std::string& result, const TruthSource& truth) {
  EvalInputs inputs;
  inputs.result = result;
  inputs.truth = truth;
  return evaluate(session, inputs);
}

// The report in a file, or of the result in it.
Report find_report(Session& session, const std::string& path, const TruthSource& truth) {
  const Json json = read_json(path, ErrorKind::data);
  if (!is_result(schema_of(json))) return parse_report(json, path);
  if (!truth.is_given())
    throw Error(ErrorKind::usage,
                "{}: is a result. Add --ground-truth or --dataset to evaluate it, or pass its "
                "report (vpr-eval {} -o REPORT)",
                path, path);
  return evaluate_by(session, path, truth).report;
}

void claim_outputs(const Session& session, const CompareInputs& inputs) {
  if (!inputs.names.empty() && inputs.names.size() != inputs.reports.size())
    throw Error(ErrorKind::usage,
                "--name is needed for each report, in their order: there are {} reports and {}",
                inputs.reports.size(), counted(inputs.names.size(), "name"));
  session.claim_output({inputs.html}, inputs.plots);
}

std::string tables_of(const ComparisonReport& comparison, TableFormat format) {
  if (format == TableFormat::csv) return render_table(comparison_rows(comparison), format);
  if (format == TableFormat::latex) return render_table(short_table(comparison), format);
  return render_table(paper_table(comparison), format) + "\n" +
         render_table(comparison_table(comparison), format);
}

ComparisonSettings settings_of(const Session& session, const CompareInputs& inputs,
                               const std::vector<Report>& reports) {
  ComparisonSettings settings{inputs.block, kResamples, session.options.process.seed,
                              inputs.only_common,
                              inputs.allow_different || compare_ground_truths(reports) ==
                                                            GroundTruths::of_places_and_frames};
  if (settings.block > 0) return settings;
  settings.block = kMinBlock;
  for (const Report& report : reports)
    settings.block = std::max(settings.block, report.outcomes.window_length);
  return settings;
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
  comparison.settings = settings_of(session, inputs, comparison.reports);
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
                                   tables_of(comparison, inputs.format)),
                       json);
}

/// The JSON files in the folder and its subfolders, except in databases, in natural order.
std::vector<std::string> json_files(const std::string& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error))
    throw Error(ErrorKind::input, "{}: is not a folder", folder);
  std::vector<std::string> files;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error)) {
    if (entry->is_directory() && entry->path().extension() == ".vprdb")
      entry.disable_recursion_pending();
    else if (entry->is_regular_file() && entry->path().extension() == ".json")
      files.push_back(entry->path().string());
  }
  if (error) throw Error(ErrorKind::input, "{}: {}", folder, error.message());
  std::ranges::sort(files, natural_less);
  return files;
}

/// At most one report per method and query.
struct Grid {
  std::vector<Report> reports;
  std::map<std::pair<std::string, std::string>, std::string> paths;  ///< by method and query
  std::set<std::string> evaluated;                                   ///< fingerprints of results

  void add(const std::string& path, Report report) {
    report.row_name = grid_name(report);
    const auto [found, is_new] = paths.insert({{report.row_name, report.query}, path});
    if (!is_new)
      throw Error(ErrorKind::usage,
                  "{} and {} are both of {} on {}. Name them with vpr-eval --name, or remove one",
                  found->second, path, report.row_name, report.query);
    evaluated.insert(report.provenance.evaluated());
    reports.push_back(std::move(report));
  }
};

/// Reads the reports of the folder, and evaluates its other results if there is a ground truth.
/// Protects these files from being replaced; an output of an earlier run may be replaced.
Grid read_grid(Session& session, const ReportInputs& inputs) {
  Grid grid;
  std::vector<std::string> results;
  for (const std::string& path : json_files(inputs.folder)) {
    const Json json = read_json(path, ErrorKind::data);
    const std::string schema = schema_of(json);
    if (!is_result(schema) && !schema.starts_with("vpr.report/")) continue;
    session.outputs.protect(path);
    if (!is_result(schema)) {
      grid.add(path, parse_report(json, path));
      continue;
    }
    results.push_back(path);
    for (const auto& array : array_paths(path)) session.outputs.protect(array);
  }
  if (inputs.truth.is_given()) {
    for (const std::string& path : std::exchange(results, {})) {
      Evaluated evaluated = evaluate_by(session, path, inputs.truth);
      if (!grid.evaluated.contains(evaluated.evaluation.fingerprint))
        grid.add(path, std::move(evaluated.report));
    }
  }
  const size_t skipped = results.size();
  if (grid.reports.empty())
    throw Error(ErrorKind::input, "{}: there are no reports of vpr-eval{}", inputs.folder,
                skipped > 0
                    ? fmt::format(", but {}. Add --dataset or --ground-truth to evaluate results",
                                  counted(skipped, "result"))
                    : "");
  if (skipped > grid.reports.size())
    warn(session.monitor,
         "{}: {} may have no report. Add --dataset or --ground-truth to evaluate results",
         inputs.folder, counted(skipped - grid.reports.size(), "result"));
  return grid;
}

/// Names queries with equal ground truths alike, by the first that has a name, unless a method has
/// reports on several of them.
std::vector<Report> with_common_queries(std::vector<Report> reports) {
  std::map<std::string, std::vector<Report*>> by_truth;
  for (Report& report : reports) by_truth[report.provenance.ground_truth].push_back(&report);
  for (const auto& [truth, group] : by_truth) {
    std::set<std::string> methods;
    for (const Report* report : group) methods.insert(report->row_name);
    if (methods.size() < group.size()) continue;
    const auto named = std::ranges::find_if(
        group, [](const Report* report) { return report->query != kUnnamedQuery; });
    if (named == group.end()) continue;
    const std::string query = (*named)->query;
    for (Report* report : group) report->query = query;
  }
  return reports;
}

/// The reports on each query, in their order.
std::vector<std::vector<Report>> by_query(std::span<const Report> grid) {
  std::vector<std::vector<Report>> queries;
  for (const Report& report : grid) {
    const auto known = std::ranges::find(
        queries, report.query, [](const auto& of_query) { return of_query.front().query; });
    (known == queries.end() ? queries.emplace_back() : *known).push_back(report);
  }
  return queries;
}

std::string overview_texts(std::span<const Report> grid) {
  std::string text;
  for (const std::vector<Report>& reports : by_query(grid))
    text += (text.empty() ? "" : "\n") + overview_text(reports, "method");
  return text;
}

Table overview_of(std::span<const Report> grid) {
  std::vector<Report> reports(grid.begin(), grid.end());
  const std::string& query = grid.front().query;
  if (std::ranges::count(grid, query, &Report::query) < std::ssize(grid))
    for (Report& report : reports)
      report.row_name = fmt::format("{} on {}", report.row_name, report.query);
  return overview_table(reports, "method");
}

std::string tables_of(std::span<const Report> grid, TableFormat format) {
  if (format == TableFormat::csv) return render_table(grid_rows(grid), format);
  if (format == TableFormat::latex) return render_table(overview_of(grid), format);
  std::string text;
  for (const Table& table : grid_tables(grid))
    text += (text.empty() ? "" : "\n") + render_table(table, format);
  return text;
}

void warn_about_truths(const Monitor& monitor, std::span<const Report> grid) {
  for (const std::vector<Report>& reports : by_query(grid)) {
    if (compare_ground_truths(reports) == GroundTruths::same) continue;
    std::set<std::string> fingerprints;
    std::vector<std::string> truths;
    for (const Report& report : reports)
      if (fingerprints.insert(report.provenance.ground_truth).second)
        truths.push_back(
            fmt::format("\"{}\" of {}", report.protocol.ground_truth, report.row_name));
    warn(monitor, "{}: the reports have different ground truths: {}", reports.front().query,
         fmt::join(truths, ", "));
  }
}

void run_report(Session& session, const ReportInputs& inputs) {
  session.claim_output({inputs.html});
  const Stopwatch watch;
  const Grid grid = read_grid(session, inputs);
  const Json json = reports_json("reports", grid.reports, session.run, watch.elapsed_s());
  session.write_output(json);
  const std::string title = inputs.truth.dataset.empty()
                                ? fs::path(inputs.folder).lexically_normal().filename().string()
                                : read_dataset(inputs.truth.dataset).name;
  const std::vector<Report> shown = with_common_queries(grid.reports);
  warn_about_truths(session.monitor, shown);
  if (!inputs.html.empty()) session.outputs.file(inputs.html).write(grid_page(title, shown));
  session.print_result(
      output_text(session, inputs.format, overview_texts(shown), tables_of(shown, inputs.format)),
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
  add_format_flag(command, inputs->format, kFormatHelp).group(kMoreGroup);
}

void add_report(Program& program) {
  const auto inputs = std::make_shared<ReportInputs>();
  const Command command =
      program.add_command("report", "Show the reports of a folder as a table and a page.",
                          "  vpr-eval report . --ground-truth pairs.csv --html results.html\n"
                          "  vpr-eval report results --dataset dataset.json --format latex",
                          [inputs](Session& session) { run_report(session, *inputs); });
  command
      .add_option("FOLDER", inputs->folder,
                  "folder with reports of vpr-eval or results of vpr-query, also in subfolders")
      .required();
  add_truth_flags(command, inputs->truth);
  command.add_option("--html", inputs->html,
                     "HTML page with tables, and for each query curves and paths of all methods",
                     kEssentialGroup, "FILE");
  add_format_flag(command, inputs->format, kFormatHelp).group(kMoreGroup);
}

}  // namespace vpr
