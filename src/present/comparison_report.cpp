#include "present/comparison_report.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.h"
#include "base/text.h"
#include "files/report.h"
#include "present/evaluation_text.h"
#include "present/report_tables.h"
#include "present/summary.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

// The protocol of the recording's ground truth, without the selection of the query.
std::string recording_protocol(const Report& report) {
  std::string protocol = report.protocol.ground_truth;
  const std::string selection = ", query " + selection_text(report.selection);
  const size_t at = protocol.rfind(selection);
  if (!report.selection_words().empty() && at != std::string::npos)
    protocol.erase(at, selection.size());
  return protocol;
}

using Value = std::optional<double>;

constexpr std::array<std::string_view, 3> kPathKeys = {"share", "incorrect", "longest_gap_frames"};

Json number_json(const Metric& metric, Value value) {
  if (value && metric.digits == 0) return static_cast<uint64_t>(*value);
  return or_null(value);
}

// "filter" of filter.report.json.
std::string method_name(const fs::path& path) {
  fs::path stem = path.stem();
  return (stem.extension() == ".report" ? stem.stem() : stem).string();
}

// The difference to the first report, and the ends of its interval.
std::array<Value, 3> differences(const ComparedValue& value) {
  if (!value.interval) return {value.difference, {}, {}};
  return {value.difference, value.interval->low, value.interval->high};
}

// Empty if the interval contains 0, and if best matches of the reports are not judged.
std::string verdict_of(const ComparisonReport& comparison, const ComparedValue& value) {
  if (!value.interval || lack_labels(comparison.reports)) return "";
  const bool is_higher = value.interval->low > 0;
  if (!is_higher && value.interval->high >= 0) return "";
  return is_higher != value.metric.metric->is_low_good ? "better" : "worse";
}

Value value_of(const ComparisonReport& comparison, size_t report, const MetricAt& metric) {
  if (metric.metric->of_path) return value_of(comparison.reports[report], metric);
  for (const ComparedValue& value : comparison.found.values)
    if (value.metric == metric && value.method == report) return value.value;
  return {};
}

std::string note_of(const ComparisonReport& comparison, size_t r) {
  const Report& report = comparison.reports[r];
  std::vector<std::string> notes;
  if (!report.selection_words().empty()) notes.push_back(report.selection_words());
  if (!comparison.is_paired(r))
    notes.push_back(fmt::format("not paired, over {} of its own",
                                counted(report.counts.best_match.frames, "frame")));
  if (report.is_oracle) notes.emplace_back("threshold from the ground truth");
  if (const std::string caution = caution_of(report); !caution.empty()) notes.push_back(caution);
  if (compare_ground_truths(comparison.reports) != GroundTruths::same)
    notes.push_back(report.protocol.ground_truth);
  return fmt::format("{}", fmt::join(notes, "; "));
}

// The report over these frames of the query alone.
void restrict_to(Report& report, const std::vector<size_t>& frames) {
  std::vector<QueryOutcome>& queries = report.outcomes.queries;
  std::vector<Verdict> verdicts;
  uint64_t off_map = 0;
  for (size_t frame = 0; frame < queries.size(); ++frame) {
    if (std::ranges::binary_search(frames, frame)) {
      verdicts.push_back(report.verdicts[frame]);
      off_map += !queries[frame].has_match && verdicts.back() == Verdict::incorrect;
      continue;
    }
    queries[frame] = QueryOutcome{};
    queries[frame].frame = frame;
    report.verdicts[frame] = Verdict::none;
  }
  report.counts.best_match = best_match_counts(report.outcomes);
  report.localization = localize(verdicts, {});
  report.localization.frames_with_match = report.counts.best_match.frames;
  report.localization.off_map = off_map;
  report.metrics.curves.single_best = numbers_of(single_best_curve(report.outcomes));
}

/// A row per report; `title` has a place for the common queries. The best of paired reports is
/// bold.
Table method_table(const ComparisonReport& comparison, fmt::format_string<std::string> title,
                   std::span<const MetricAt> columns) {
  const std::vector<Report>& reports = comparison.reports;
  Table table;
  table.title = fmt::format("{}: {}{}", comparison.query(), fmt::format(title, comparison.frames()),
                            off_map_words(reports));
  table.columns = {"method"};
  for (const Report& report : reports) table.rows.push_back({report.row_name});
  const bool all_oracle = std::ranges::all_of(reports, &Report::is_oracle);
  for (const MetricAt& column : columns) {
    const Metric& metric = *column.metric;
    std::vector<Value> values;
    for (size_t r = 0; r < reports.size(); ++r) {
      values.push_back(value_of(comparison, r, column));
      table.rows[r].push_back(metric_cell(metric, values.back()));
      // An easier query, or a threshold from the ground truth, does not make a better method.
      if (!comparison.is_paired(r) || (metric.of_path && reports[r].is_oracle != all_oracle) ||
          lack_labels(reports))
        values.back() = {};
    }
    if (std::ranges::count_if(values, &Value::has_value) > 1 &&
        metric.key != "incorrect")  // a method without verdicts has none that are wrong
      mark_best(table, table.columns.size(), values, metric.is_low_good);
    table.columns.push_back(column.symbol());
  }
  return table;
}

Json named_report_json(const ComparisonReport& comparison, size_t r) {
  const Report& report = comparison.reports[r];
  Json json = {{"name", report.row_name},
               {"method", report.method},
               {"ground_truth", report.protocol.ground_truth},
               {"frames", report.counts.best_match.frames},
               {"paired", comparison.is_paired(r)},
               {"localization", Json::object()},
               {"oracle", report.is_oracle},
               {"confidence", enum_name(report.outcomes.confidence)},
               {"fingerprint", report.provenance.evaluated()}};
  for (const std::string_view key : kPathKeys)
    json["localization"][std::string(key)] =
        number_json(find_metric(key), value_of(report, metric_at(key)));
  if (!report.selection_words().empty()) json["selection"] = report.selection_words();
  json["ground_truth_fingerprint"] = report.provenance.ground_truth;
  return json;
}

}  // namespace

GroundTruths compare_ground_truths(std::span<const Report> reports) {
  std::map<bool, std::string> of_kind;  // places or frames
  for (const Report& report : reports) {
    if (report.selection_words() != reports.front().selection_words()) {
      // Fingerprints of different selections always differ.
      if (recording_protocol(report) != recording_protocol(reports.front()))
        return GroundTruths::different;
      continue;
    }
    const std::string& fingerprint = report.provenance.ground_truth;
    if (of_kind.emplace(report.has_places(), fingerprint).first->second != fingerprint)
      return GroundTruths::different;
  }
  const bool agree = of_kind.size() < 2 || of_kind[true] == of_kind[false];
  return agree ? GroundTruths::same : GroundTruths::of_places_and_frames;
}

void name_rows(std::vector<Report>& reports, const std::vector<std::string>& paths) {
  std::vector<std::string> names;
  for (size_t r = 0; r < reports.size(); ++r)
    names.push_back(reports[r].name.value_or(method_name(paths[r])));
  names = numbered_names(names);
  for (size_t r = 0; r < reports.size(); ++r) reports[r].row_name = names[r];
}

std::string ComparisonReport::query() const {
  const auto named = std::ranges::find_if(
      reports, [](const Report& report) { return report.query != kUnnamedQuery; });
  return named == reports.end() ? kUnnamedQuery : named->query;
}

std::string ComparisonReport::frames() const {
  return fmt::format("{} {}",
                     counted(found.with_match, settings.only_common ? "common frame" : "frame"),
                     reports.front().frames_that_count());
}

void compare_reports(ComparisonReport& comparison, const Monitor& monitor) {
  std::vector<NamedOutcomes> methods;
  for (size_t r = 0; r < comparison.reports.size(); ++r)
    methods.push_back(
        {comparison.reports[r].row_name, comparison.reports[r].outcomes, comparison.is_paired(r)});
  comparison.found = compare_outcomes(methods, comparison.settings, monitor);
  for (size_t r = 0; r < comparison.reports.size(); ++r)
    if (comparison.is_paired(r)) restrict_to(comparison.reports[r], comparison.found.frames);
}

Json comparison_json(const ComparisonReport& comparison) {
  const Comparison& found = comparison.found;
  Json json = {{"schema", schema_name("comparison")},
               {"query", comparison.query()},
               {"reports", Json::array()}};
  for (size_t r = 0; r < comparison.reports.size(); ++r)
    json["reports"].push_back(named_report_json(comparison, r));
  json["ground_truths"] = enum_name(compare_ground_truths(comparison.reports));
  json["frames"] = {{"compared", found.frames.size()},
                    {"with_match", found.with_match},
                    {"disputed", found.disputed},
                    {"only_common", comparison.settings.only_common}};
  json["bootstrap"] = {
      {"block", found.block}, {"resamples", comparison.settings.resamples}, {"confidence", 0.95}};
  json["metrics"] = Json::array();
  for (const ComparedValue& value : found.values) {
    const auto [difference, low, high] = differences(value);
    json["metrics"].push_back({{"metric", value.metric.key()},
                               {"report", comparison.reports[value.method].row_name},
                               {"value", or_null(value.value)},
                               {"difference", or_null(difference)},
                               {"low", or_null(low)},
                               {"high", or_null(high)}});
  }
  json["protocol"] = {
      {"frames",
       comparison.settings.only_common
           ? "query frames for which every paired report has a best match that is not ignored"
           : "all query frames except disputed ones; a frame without an answer is not recognized; "
             "a report of another selection is not paired, and is measured over its own"},
      {"localization",
       "share of the frames with a match that are recognized correctly, frames recognized "
       "incorrectly, and most consecutive frames without a correct recognition"},
      {"oracle",
       "recognitions of a report with an oracle threshold are best matches up to a threshold that "
       "was chosen from the ground truth"},
      {"confidence", "the value by which AP, R@100P, max F1 and curves accept best matches"},
      {"disputed", "omitted frames, which have a match in only some of the ground truths"},
      {"metrics",
       "of best matches; an accepted best match of a frame without a match is incorrect"},
      {"interval",
       "central 95 % of the difference to the first report under the circular block bootstrap, "
       "the same blocks of neighboring frames for all reports"}};
  json["provenance"] = value_to_json(comparison.made_by);
  return json;
}

Table paper_table(const ComparisonReport& comparison) {
  const MetricAt columns[] = {metric_at("recall_at", 1),
                              metric_at("recall_at", 5),
                              metric_at("recall_at", 10),
                              metric_at("average_precision"),
                              metric_at("recall_at_100_precision"),
                              metric_at("max_f1"),
                              metric_at(kPathKeys[0]),
                              metric_at(kPathKeys[1]),
                              metric_at(kPathKeys[2])};
  Table table = method_table(comparison, "over {}; longest gap in frames", columns);
  std::vector<std::string> notes;
  for (size_t r = 0; r < table.rows.size(); ++r) notes.push_back(note_of(comparison, r));
  if (std::ranges::all_of(notes, &std::string::empty)) return table;
  table.columns.emplace_back("note");
  for (size_t r = 0; r < table.rows.size(); ++r) table.rows[r].push_back(notes[r]);
  return table;
}

Table short_table(const ComparisonReport& comparison) {
  std::vector<MetricAt> columns = {metric_at("recall_at", 1), metric_at("average_precision"),
                                   metric_at("recall_at_100_precision")};
  const MetricAt recall_at_5 = metric_at("recall_at", 5);
  if (std::ranges::any_of(comparison.found.values, [&](const ComparedValue& value) {
        return value.metric == recall_at_5 && value.value;
      }))
    columns.insert(columns.begin() + 1, recall_at_5);
  Table table =
      method_table(comparison, "over {}; correct and incorrect: recognized frames", columns);
  table.label = "comparison";
  for (const auto& [column, count] : {std::pair("correct", &Localization::correct),
                                      std::pair("incorrect", &Localization::incorrect)}) {
    table.columns.emplace_back(column);
    for (size_t r = 0; r < table.rows.size(); ++r) {
      const Report& report = comparison.reports[r];
      table.rows[r].push_back(report.is_oracle ? "-" : fmt::to_string(report.localization.*count));
    }
  }
  return table;
}

std::string comparison_text(const ComparisonReport& comparison) {
  Table table = short_table(comparison);
  table.title.clear();
  std::vector<std::string> best;
  for (const auto& [row, column] : table.best)
    if (column == 1) best.push_back(comparison.reports[row].row_name);
  std::string text;
  if (!best.empty())
    text = wrapped_text(fmt::format("Highest R@1, over {}: {}.", comparison.frames(),
                                    fmt::join(best, ", "))) +
           "\n";
  text += short_text(table);
  for (size_t r = 0; r < comparison.reports.size(); ++r)
    if (const std::string note = note_of(comparison, r); !note.empty())
      text += wrapped_text(fmt::format("{}: {}", comparison.reports[r].row_name, note), 2);
  for (const ComparedValue& value : comparison.found.values)
    if (value.metric == metric_at("recall_at", 1) && value.interval) {
      const std::string verdict = verdict_of(comparison, value);
      text += wrapped_text(
          fmt::format("{} - {}: R@1 {:+.4f} (95 %: {:+.4f} to {:+.4f}){}",
                      comparison.reports[value.method].row_name,
                      comparison.reports.front().row_name, *value.difference, value.interval->low,
                      value.interval->high, verdict.empty() ? "" : ", " + verdict),
          2);
    }
  return text;
}

Table comparison_table(const ComparisonReport& comparison) {
  const Comparison& found = comparison.found;
  Table table;
  table.title =
      fmt::format("{}: differences to {} over {}, 95 % by blocks of {}", comparison.query(),
                  comparison.reports.front().row_name, comparison.frames(), found.block);
  const GroundTruths truths = compare_ground_truths(comparison.reports);
  if (truths != GroundTruths::same)
    table.title += fmt::format("; ground truths: {}", enum_name(truths));
  table.columns = {"metric", "of", "value", "difference", "from", "to", ""};
  for (const ComparedValue& value : found.values) {
    if (!value.value) continue;
    std::vector<std::string>& row = table.rows.emplace_back();
    row = {value.metric.key(), comparison.reports[value.method].row_name,
           metric_cell(*value.metric.metric, value.value)};
    for (const Value& number : differences(value))
      row.push_back(number ? fmt::format("{:+.4f}", *number) : "-");
    row.push_back(verdict_of(comparison, value));
  }
  return table;
}

Table comparison_rows(const ComparisonReport& comparison) {
  const auto text = [](const Metric& metric, Value value) {
    return value ? number_json(metric, value).dump() : "";
  };
  const std::string truths(enum_name(compare_ground_truths(comparison.reports)));
  Table table;
  table.columns = {"query", "report",     "selection", "ground_truths", "metric",
                   "value", "difference", "low",       "high",          "verdict"};
  for (size_t r = 0; r < comparison.reports.size(); ++r) {
    const Report& report = comparison.reports[r];
    const auto add = [&](const MetricAt& at, Value number, const std::array<Value, 3>& difference,
                         const std::string& verdict) {
      const Metric& metric = *at.metric;
      table.rows.push_back({comparison.query(), comparison.reports[r].row_name,
                            report.selection_words(), truths, at.key(), text(metric, number),
                            text(metric, difference[0]), text(metric, difference[1]),
                            text(metric, difference[2]), verdict});
    };
    for (const ComparedValue& value : comparison.found.values)
      if (value.method == r)
        add(value.metric, value.value, differences(value), verdict_of(comparison, value));
    for (const std::string_view key : kPathKeys)
      add(metric_at(key), value_of(report, metric_at(key)), {}, "");
  }
  return table;
}

}  // namespace vpr
