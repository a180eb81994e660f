#include "present/comparison_report.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.h"
#include "base/json_fields.h"
#include "base/text.h"
#include "present/evaluation_charts.h"
#include "present/evaluation_report.h"
#include "present/html_page.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr double kLaneGap = 0.15;  // on both sides of a lane that is 1 high
constexpr double kLaneHeight = 34;

// The protocol of the recording's ground truth, without the selection of the query.
std::string recording_protocol(const Report& report) {
  std::string protocol = report.protocol.ground_truth;
  if (!report.selection_words().empty())
    for (const std::string_view selection : {", query at speed ", ", query resampled "})
      protocol = protocol.substr(0, protocol.find(selection));
  return protocol;
}

using Value = std::optional<double>;

constexpr std::array<std::string_view, 3> kPathKeys = {"share", "incorrect", "longest_gap_frames"};

Value path_value(const Report& report, std::string_view key) {
  return find_metric(key).of_path(report.localization);
}

Json number_json(const Metric& metric, Value value) {
  if (value && metric.digits == 0) return static_cast<uint64_t>(*value);
  return or_null(value);
}

// The difference to the first report, and the ends of its interval.
std::array<Value, 3> differences(const ComparedValue& value) {
  if (!value.interval) return {value.difference, {}, {}};
  return {value.difference, value.interval->low, value.interval->high};
}

// Empty if the interval contains 0.
std::string verdict_of(const ComparedValue& value) {
  if (!value.interval) return "";
  const bool is_higher = value.interval->low > 0;
  if (!is_higher && value.interval->high >= 0) return "";
  return is_higher != value.metric->is_low_good ? "better" : "worse";
}

/// A metric, with K for metrics of ranks.
struct PaperColumn {
  std::string_view key;
  size_t k = 0;
};

constexpr std::array<PaperColumn, 9> kPaperColumns = {{{"recall_at", 1},
                                                       {"recall_at", 5},
                                                       {"recall_at", 10},
                                                       {"average_precision"},
                                                       {"recall_at_100_precision"},
                                                       {"max_f1"},
                                                       {kPathKeys[0]},
                                                       {kPathKeys[1]},
                                                       {kPathKeys[2]}}};

Value value_of(const ComparisonReport& comparison, size_t report, const Metric& metric, size_t k) {
  if (metric.of_path != nullptr) return metric.of_path(comparison.reports[report].localization);
  const std::string key = k > 0 ? fmt::format("{}_{}", metric.key, k) : std::string(metric.key);
  for (const ComparedValue& value : comparison.found.values)
    if (value.key == key && value.method == report) return value.value;
  return {};
}

std::string note_of(const ComparisonReport& comparison, size_t r) {
  const Report& report = comparison.reports[r];
  std::vector<std::string> notes;
  if (!report.selection_words().empty()) notes.push_back(report.selection_words());
  if (!comparison.is_paired(r))
    notes.push_back(fmt::format("not paired, over {} of its own",
                                counted(comparison.found.own[r], "query", "queries")));
  if (report.is_oracle) notes.emplace_back("threshold from the ground truth");
  if (compare_ground_truths(comparison.reports) != GroundTruths::same)
    notes.push_back(report.protocol.ground_truth);
  return fmt::format("{}", fmt::join(notes, "; "));
}

std::string common_queries(const Comparison& found) {
  return fmt::format("{} ({} with a match)",
                     counted(found.common, "common query", "common queries"), found.judged);
}

Json named_report_json(const ComparisonReport& comparison, size_t r) {
  const Report& report = comparison.reports[r];
  Json json = {{"name", comparison.names[r]},
               {"method", report.method},
               {"ground_truth", report.protocol.ground_truth},
               {"queries", comparison.found.own[r]},
               {"paired", comparison.is_paired(r)},
               {"localization", Json::object()},
               {"oracle", report.is_oracle},
               {"confidence", enum_name(report.outcomes.confidence)},
               {"fingerprint", report.provenance.evaluated()}};
  for (const std::string_view key : kPathKeys)
    json["localization"][std::string(key)] = number_json(find_metric(key), path_value(report, key));
  if (!report.selection_words().empty()) json["selection"] = report.selection_words();
  json["ground_truth_fingerprint"] = report.provenance.ground_truth;
  return json;
}

std::string title_of(const ComparisonReport& comparison) {
  return fmt::format("{} on {}", counted(comparison.reports.size(), "method"), comparison.query());
}

// "Best matches of the 51 common queries are right in 80.4 % by mine, 61.8 % by theirs."
std::string sentence_of(const ComparisonReport& comparison) {
  std::string text;
  for (const ComparedValue& value : comparison.found.values)
    if (value.key == "recall_at_1" && value.value)
      text += fmt::format("{}{:.1f} % by {}",
                          text.empty()
                              ? fmt::format("Best matches of the {} common queries are right in ",
                                            comparison.found.judged)
                              : ", ",
                          100 * *value.value, comparison.names[value.method]);
  return text.empty() ? "The queries have nothing to find." : text + ".";
}

/// One curve per report, over its own queries; empty if no query has a match.
Chart curves_overlay(const std::string& title, std::span<const Report> reports,
                     const std::vector<std::string>& names) {
  Chart chart = precision_recall_chart(title);
  for (size_t r = 0; r < reports.size(); ++r) {
    const Curve curve = single_best_curve(reports[r].outcomes);
    Series series{names[r], {}, SeriesStyle::line};
    if (curve.to_find > 0) series.points = curve_points(curve, 1000);
    chart.series.push_back(series);
  }
  return chart;
}

/// The verdicts of all query frames, one lane per report. Lanes of different selections differ in
/// length.
Chart lanes_chart(const std::string& title, std::span<const Report> reports,
                  const std::vector<std::string>& names) {
  Chart chart{"lanes", title, {"query frame"}};
  for (const Meaning meaning : {Meaning::unjudged, Meaning::wrong, Meaning::right})
    chart.series.push_back(series_of(meaning, SeriesStyle::boxes));
  size_t frames = 1;
  for (size_t r = 0; r < reports.size(); ++r) {
    const auto top = static_cast<double>(r);
    for (const ChartRun& run : fix_runs(reports[r].verdicts)) {
      Series& boxes = *std::ranges::find(chart.series, run.meaning, &Series::meaning);
      boxes.points.emplace_back(run.begin, top + 1 - kLaneGap);
      boxes.points.emplace_back(run.end, top + kLaneGap);
    }
    frames = std::max(frames, reports[r].verdicts.size());
    chart.y.ticks.push_back({top + 0.5, names[r]});
  }
  erase_empty_series(chart);
  chart.x.range = {0, static_cast<double>(frames)};
  chart.y.range = {static_cast<double>(reports.size()), 0};
  chart.width = 1000;
  chart.height = 130 + kLaneHeight * static_cast<double>(reports.size());
  return chart;
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

std::vector<std::string> report_names(std::span<const Report> reports,
                                      const std::vector<std::string>& paths) {
  std::vector<std::array<std::string, 3>> choices;  // the last is unique
  for (size_t r = 0; r < reports.size(); ++r) {
    const std::string second = reports[r].name.value_or(fs::path(paths[r]).stem().string());
    choices.push_back({reports[r].name.value_or(reports[r].method), second,
                       fmt::format("{} ({})", second, r + 1)});
  }
  std::vector<size_t> chosen(reports.size(), 0);
  const auto clashes = [&](size_t r) {
    for (size_t other = 0; other < reports.size(); ++other)
      if (other != r && choices[other][chosen[other]] == choices[r][chosen[r]] &&
          (reports[other].name || !reports[r].name))  // a user's name yields to another only
        return true;
    return false;
  };
  for (size_t level = 0; level < 2; ++level) {
    std::vector<size_t> next = chosen;
    for (size_t r = 0; r < reports.size(); ++r)
      if (chosen[r] == level && clashes(r)) next[r] = level + 1;
    chosen = next;
  }
  std::vector<std::string> names;
  for (size_t r = 0; r < reports.size(); ++r) names.push_back(choices[r][chosen[r]]);
  return names;
}

std::string ComparisonReport::query() const {
  const auto named = std::ranges::find_if(
      reports, [](const Report& report) { return report.query != kUnnamedQuery; });
  return named == reports.end() ? kUnnamedQuery : named->query;
}

Json comparison_json(const ComparisonReport& comparison) {
  const Comparison& found = comparison.found;
  Json json = {
      {"schema", "vpr.comparison/3"}, {"query", comparison.query()}, {"reports", Json::array()}};
  for (size_t r = 0; r < comparison.reports.size(); ++r)
    json["reports"].push_back(named_report_json(comparison, r));
  json["ground_truths"] = enum_name(compare_ground_truths(comparison.reports));
  json["queries"] = {
      {"common", found.common}, {"with_match", found.judged}, {"disputed", found.disputed}};
  json["bootstrap"] = {
      {"block", found.block}, {"resamples", comparison.resamples}, {"confidence", 0.95}};
  json["metrics"] = Json::array();
  for (const ComparedValue& value : found.values) {
    const auto [difference, low, high] = differences(value);
    json["metrics"].push_back({{"metric", value.key},
                               {"report", comparison.names[value.method]},
                               {"value", or_null(value.value)},
                               {"difference", or_null(difference)},
                               {"low", or_null(low)},
                               {"high", or_null(high)}});
  }
  json["paired"] = Json::array();
  for (size_t r = 1; r < comparison.reports.size(); ++r) {
    if (!comparison.is_paired(r)) continue;
    const PairedCounts& counts = found.paired[r];
    json["paired"].push_back({{"report", comparison.names[r]},
                              {"both_correct", counts.both_correct},
                              {"only_this", counts.only_this},
                              {"only_first", counts.only_first},
                              {"neither", counts.neither}});
  }
  json["protocol"] = {
      {"queries",
       "query frames that all reports judge: readable, not ignored, and within reach of the "
       "windows "
       "of every report; a report of another selection is not paired, and is measured over its "
       "own"},
      {"localization",
       "share of all frames of the path with a correct recognition, frames with an incorrect "
       "recognition, and most consecutive frames without a correct recognition, by the reports"},
      {"oracle",
       "recognitions of a report with an oracle threshold are best matches up to a threshold that "
       "was chosen from the ground truth"},
      {"confidence", "the value by which AP, R@100P, max F1 and curves accept best matches"},
      {"disputed", "omitted query frames, which have a match in only some of the ground truths"},
      {"metrics",
       "of best matches; an accepted best match of a query without a match is incorrect"},
      {"interval",
       "central 95 % of the difference to the first report under the circular block bootstrap, "
       "the same blocks of neighboring queries for all reports"}};
  json["provenance"] = fields_to_json(comparison.made_by);
  return json;
}

Table paper_table(const ComparisonReport& comparison) {
  const std::vector<Report>& reports = comparison.reports;
  Table table;
  table.title =
      fmt::format("{}: over {}; share, wrong and longest gap (frames) over the whole path",
                  comparison.query(), common_queries(comparison.found));
  const bool all_oracle = std::ranges::all_of(reports, &Report::is_oracle);
  table.columns = {"method"};
  for (const std::string& name : comparison.names) table.rows.push_back({name});
  for (const auto& [key, k] : kPaperColumns) {
    const Metric& metric = find_metric(key);
    std::vector<Value> values;
    for (size_t r = 0; r < reports.size(); ++r) {
      values.push_back(value_of(comparison, r, metric, k));
      table.rows[r].push_back(metric_cell(metric, values.back()));
      // An easier query, or a threshold from the ground truth, does not make a better method.
      const bool is_of_path = metric.of_path != nullptr;
      if (!comparison.is_paired(r) || (is_of_path && reports[r].is_oracle != all_oracle))
        values.back() = {};
    }
    const auto known = std::ranges::count_if(values, &Value::has_value);
    if (known > 1 &&
        metric.key != "incorrect")  // a method without verdicts has none that are wrong
      mark_best(table, table.columns.size(), values, metric.is_low_good);
    table.columns.push_back(k > 0 ? fmt::format("{}{}", metric.symbol, k)
                                  : std::string(metric.symbol));
  }
  std::vector<std::string> notes;
  for (size_t r = 0; r < reports.size(); ++r) notes.push_back(note_of(comparison, r));
  if (std::ranges::all_of(notes, &std::string::empty)) return table;
  table.columns.emplace_back("note");
  for (size_t r = 0; r < reports.size(); ++r) table.rows[r].push_back(notes[r]);
  return table;
}

Table comparison_table(const ComparisonReport& comparison) {
  const Comparison& found = comparison.found;
  Table table;
  table.title =
      fmt::format("{}: differences to {} over {}, 95 % by blocks of {}", comparison.query(),
                  comparison.names.front(), common_queries(found), found.block);
  const GroundTruths truths = compare_ground_truths(comparison.reports);
  if (truths != GroundTruths::same)
    table.title += fmt::format("; ground truths: {}", enum_name(truths));
  table.columns = {"metric", "of", "value", "difference", "from", "to", ""};
  for (const ComparedValue& value : found.values) {
    if (!value.value) continue;
    std::vector<std::string>& row = table.rows.emplace_back();
    row = {value.key, comparison.names[value.method], metric_cell(*value.metric, value.value)};
    for (const Value& number : differences(value))
      row.push_back(number ? fmt::format("{:+.4f}", *number) : "-");
    row.push_back(verdict_of(value));
  }
  return table;
}

Table paired_table(const ComparisonReport& comparison) {
  Table table;
  table.title = fmt::format("Best matches compared with {}", comparison.names.front());
  table.columns = {"of", "both correct", "only this", "only the first", "neither"};
  for (size_t r = 1; r < comparison.reports.size(); ++r) {
    if (!comparison.is_paired(r)) continue;
    const PairedCounts& counts = comparison.found.paired[r];
    add_row(table, comparison.names[r], counts.both_correct, counts.only_this, counts.only_first,
            counts.neither);
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
    const auto add = [&](const std::string& key, const Metric& metric, Value number,
                         const std::array<Value, 3>& difference, const std::string& verdict) {
      table.rows.push_back({comparison.query(), comparison.names[r], report.selection_words(),
                            truths, key, text(metric, number), text(metric, difference[0]),
                            text(metric, difference[1]), text(metric, difference[2]), verdict});
    };
    for (const ComparedValue& value : comparison.found.values)
      if (value.method == r)
        add(value.key, *value.metric, value.value, differences(value), verdict_of(value));
    for (const std::string_view key : kPathKeys)
      add(std::string(key), find_metric(key), path_value(report, key), {}, "");
  }
  return table;
}

std::string comparison_page(const ComparisonReport& comparison) {
  const std::string title = title_of(comparison);
  const Json json = comparison_json(comparison);
  Json made = json["bootstrap"];
  made.update(json["provenance"]);
  const std::string sections =
      section_html("Numbers", table_html(paper_table(comparison))) +
      section_html("Curves and paths", methods_html(title, comparison.reports, comparison.names)) +
      section_html("Differences",
                   table_html(comparison_table(comparison)) + table_html(paired_table(comparison)));
  return sections_page(title, sentence_of(comparison),
                       "Ground truth: " + comparison.reports.front().protocol.ground_truth,
                       sections, json["protocol"], made);
}

std::string methods_html(const std::string& title, std::span<const Report> reports,
                         const std::vector<std::string>& names) {
  Chart curves = curves_overlay(title, reports, names);
  curves.width = 650;
  curves.height = 450;
  const Chart lanes = lanes_chart(title, reports, names);
  std::string legend;
  for (size_t r = 0; r < reports.size(); ++r)
    legend += legend_entry(
        fmt::format("series-{}", r % series_colors().size()),
        html_escaped(fmt::format(
            "{} ({}{})", names[r], counted(judged_queries(reports[r].outcomes), "query", "queries"),
            reports[r].outcomes.confidence == Confidence::margin ? ", by margin" : "")));
  return "<div class=\"charts\">" +
         figure_html("Precision and recall of best matches, each over its own queries", curves,
                     legend) +
         "</div>\n<h3>Along the path</h3><p class=\"legend\">" + legend_html(meanings_of(lanes)) +
         "</p>" + scrolling_html(html_escaped(title), page_svg(lanes)) + "\n";
}

void draw_comparison(const ComparisonReport& comparison, const std::filesystem::path& folder) {
  const std::string title = title_of(comparison);
  draw_chart(curves_overlay(title, comparison.reports, comparison.names), folder);
  draw_chart(lanes_chart(title, comparison.reports, comparison.names), folder);
}

}  // namespace vpr
