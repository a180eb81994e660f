#include "eval_compare.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/json.h"
#include "base/stopwatch.h"
#include "report/comparison_report.h"
#include "report/scores_report.h"

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
    case GroundTruths::unknown:
      warn(monitor, fmt::format("whether the ground truths are the same is not known: reports of "
                                "older versions do not say (make them again); {}",
                                words));
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

void run_compare(Session& session, const CompareInputs& inputs) {
  const CommonOptions& options = session.options;
  session.claim_output();
  const Stopwatch watch;
  std::vector<StoredReport> reports;
  for (const std::string& path : inputs.reports) reports.push_back(read_report(path));
  const std::vector<std::string> names = report_names(reports, inputs.reports);
  warn_about_queries(session.monitor, inputs.reports, reports);
  check_ground_truths(session.monitor, inputs, reports);
  std::vector<NamedOutcomes> methods;
  for (size_t r = 0; r < reports.size(); ++r) methods.push_back({names[r], reports[r].outcomes});
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
  command.add_flag("--allow-different", inputs.allow_different,
                   "compare reports with different ground truths all the same; the output says so");
  add_setting(command, "--format", inputs.format, "of the table: text, csv, markdown or latex");
}

}  // namespace vpr
