#include "eval_compare.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "base/json.h"
#include "base/stopwatch.h"
#include "report/comparison_report.h"

namespace vpr {
namespace {

constexpr size_t kResamples = 2000;
constexpr size_t kLeastBlock = 10;

/// Methods, where these tell reports apart; else the files' names, or their paths.
std::vector<std::string> names_of(const std::vector<std::string>& paths,
                                  const std::vector<StoredReport>& reports) {
  std::vector<std::string> methods;
  std::vector<std::string> stems;
  for (size_t r = 0; r < reports.size(); ++r) {
    methods.push_back(reports[r].method);
    stems.push_back(std::filesystem::path(paths[r]).stem().string());
  }
  for (const auto& names : {methods, stems})
    if (std::set(names.begin(), names.end()).size() == names.size()) return names;
  std::vector<std::string> numbered;
  for (size_t r = 0; r < reports.size(); ++r)
    numbered.push_back(fmt::format("{} ({})", stems[r], r + 1));
  return numbered;
}

size_t block_of(const CompareInputs& inputs, const std::vector<StoredReport>& reports) {
  if (inputs.block > 0) return inputs.block;
  size_t block = kLeastBlock;
  for (const StoredReport& report : reports) block = std::max(block, report.outcomes.window_length);
  return block;
}

void warn_about_differences(const Monitor& monitor, const std::vector<std::string>& paths,
                            const std::vector<StoredReport>& reports) {
  for (size_t r = 1; r < reports.size(); ++r) {
    if (reports[r].query != reports[0].query)
      warn(monitor, fmt::format("{} is of the query {}, {} of {}", paths[0], reports[0].query,
                                paths[r], reports[r].query));
    if (reports[r].ground_truth != reports[0].ground_truth)
      warn(monitor, fmt::format("{} is judged by \"{}\", {} by \"{}\"", paths[0],
                                reports[0].ground_truth, paths[r], reports[r].ground_truth));
  }
}

void run_compare(Session& session, const CompareInputs& inputs) {
  const CommonOptions& options = session.options;
  if (!options.output.empty()) check_output_file(options.output, options.existing());
  const Stopwatch watch;
  std::vector<StoredReport> reports;
  for (const std::string& path : inputs.reports) reports.push_back(read_report(path));
  const std::vector<std::string> names = names_of(inputs.reports, reports);
  warn_about_differences(session.monitor, inputs.reports, reports);
  std::vector<NamedOutcomes> methods;
  for (size_t r = 0; r < reports.size(); ++r) methods.push_back({names[r], reports[r].outcomes});
  const Comparison comparison = compare_outcomes(methods, block_of(inputs, reports), kResamples,
                                                 options.seed, session.monitor);
  Json json = comparison_json(comparison, reports, names, kResamples, session.run);
  RunInfo info = session.run;
  for (size_t r = 0; r < reports.size(); ++r)
    info.paths[fmt::format("report_{}", r + 1)] = inputs.reports[r];
  json["machine"] = machine_json(info);
  json["timing"] = timing_json({{"compare", watch.elapsed_s()}});
  if (!options.output.empty()) write_file(options.output, to_text(json), options.existing());
  std::string text = render_table(comparison_table(json), inputs.format);
  if (inputs.format != TableFormat::csv)
    text += "\n" + render_table(paired_table(json), inputs.format);
  session.print_result(text, json);
}

}  // namespace

void add_compare(Program& program, CompareInputs& inputs) {
  const Command command = program.add_command(
      "compare", "Compare reports of methods on the same queries.",
      "  vpr-eval compare mine.json theirs.json\n"
      "  vpr-eval compare a.json b.json c.json --block 40 --json > comparison.json",
      [&](Session& session) { run_compare(session, inputs); });
  command
      .add_option("REPORT", inputs.reports,
                  "reports of vpr-eval; the first is what the others "
                  "are compared with")
      .required()
      .expected(2, 1000);
  add_setting(command, "--block", inputs.block,
              "queries that are drawn together, since neighbours depend on each other (default: "
              "the longest window, at least 10)");
  add_setting(command, "--format", inputs.format, "of the table: text, csv, markdown or latex");
}

}  // namespace vpr
