#include <algorithm>
#include <filesystem>
#include <set>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "eval_commands.h"
#include "eval_inputs.h"
#include "present/comparison_page.h"
#include "present/evaluation_report.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

/// What a folder holds, by schema.
struct FolderContent {
  std::vector<std::string> results;
  std::vector<std::pair<std::string, Json>> reports;
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
    Json json = read_json(path, ErrorKind::data);
    const std::string schema =
        json.is_object() && json.contains("schema") && json["schema"].is_string()
            ? json["schema"].get<std::string>()
            : "";
    if (schema.starts_with("vpr.result/")) content.results.push_back(path);
    if (schema.starts_with("vpr.report/")) content.reports.emplace_back(path, std::move(json));
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
  void add(const std::string& path, Json report) {
    StoredReport stored = stored_report(report, path);
    const std::string method = grid_name(report);
    const auto [found, is_new] = paths_.insert({{method, stored.query}, path});
    if (!is_new)
      throw Error(ErrorKind::usage,
                  fmt::format("{} and {} are both of {} on {}; tell them apart by vpr-eval --name, "
                              "or leave one out",
                              found->second, path, method, stored.query));
    fingerprints_.insert(stored.fingerprint);
    const std::string query = stored.query;
    reports.push_back({method, query, std::move(report), std::move(stored)});
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
  std::vector<Json> reports;
  std::vector<std::string> names;
  for (const GridReport& report : grid.reports) {
    reports.push_back(report.report);
    for (const char* part : {"machine", "timing"}) reports.back().erase(part);
    names.push_back(report.method);
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
