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
#include "present/evaluation_tables.h"
#include "present/html_page.h"

namespace vpr {
namespace {

constexpr double kLaneGap = 0.15;  // on both sides of a lane that is 1 high
constexpr double kLaneHeight = 34;

// What replayed queries add to the words of a ground truth, with their walk behind it.
constexpr std::array<std::string_view, 2> kReplayed = {", query replayed ", ", query thinned "};

std::string words_of_recording(const Report& report) {
  std::string words = report.protocol.ground_truth;
  if (report.walk().empty()) return words;
  for (const std::string_view replayed : kReplayed) words = words.substr(0, words.find(replayed));
  return words;
}

using Value = std::optional<double>;

/// Metrics of the path that comparisons show.
constexpr std::array<std::string_view, 3> kPathKeys = {"share", "wrong", "longest_gap_frames"};

Value path_value(const Report& report, std::string_view key) {
  return find_metric(key).of_path(report.localization);
}

Json number_json(const Metric& metric, Value value) {
  if (value && metric.digits == 0) return static_cast<uint64_t>(*value);
  return or_null(value);
}

std::string signed_number(Value value) { return value ? fmt::format("{:+.4f}", *value) : "-"; }

// Whether the interval leaves chance out.
std::string judgment_of(const ComparedValue& value) {
  if (!value.interval) return "";
  const bool is_higher = value.interval->low > 0;
  if (!is_higher && value.interval->high >= 0) return "";
  return is_higher != value.metric->is_low_good ? "better" : "worse";
}

/// A column of the paper's table: a metric, of ranks with its K.
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

// Marks the best of a column, all that share it; nothing where fewer than two are known.
void mark_best(Table& table, size_t column, const std::vector<Value>& values, bool is_low_good) {
  Value best;
  size_t known = 0;
  for (const Value& value : values) {
    if (!value) continue;
    ++known;
    if (!best || (is_low_good ? *value < *best : *value > *best)) best = value;
  }
  for (size_t row = 0; row < values.size() && known > 1; ++row)
    if (values[row] && *values[row] == *best) table.best.insert({row, column});
}

std::string note_of(const ComparisonReport& comparison, size_t r) {
  const Report& report = comparison.reports[r];
  std::vector<std::string> notes;
  if (!report.walk().empty()) notes.push_back(report.walk());
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
  if (!report.walk().empty()) json["walk"] = report.walk();
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

/// Precision against recall of best matches, one curve per report over its own queries. Reports
/// without a query to find have no curve.
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

/// The path from left to right, one lane per report: where it is right, wrong or not judged. A
/// replayed query has its own frames: its lane is as long as they are.
Chart lanes_chart(const std::string& title, std::span<const Report> reports,
                  const std::vector<std::string>& names) {
  Chart chart{"lanes", title, {"query frame"}};
  for (const Meaning meaning : {Meaning::unjudged, Meaning::wrong, Meaning::right})
    chart.series.push_back(series_of(meaning, SeriesStyle::boxes));
  size_t frames = 1;
  for (size_t r = 0; r < reports.size(); ++r) {
    const auto top = static_cast<double>(r);
    for (const ChartRun& run : fix_runs(reports[r].fixes)) {
      Series& boxes = *std::ranges::find(chart.series, run.meaning, &Series::meaning);
      boxes.points.emplace_back(run.begin, top + 1 - kLaneGap);
      boxes.points.emplace_back(run.end, top + kLaneGap);
    }
    frames = std::max(frames, reports[r].fixes.size());
    chart.y.ticks.push_back({top + 0.5, names[r]});
  }
  std::erase_if(chart.series, [](const Series& series) { return series.points.empty(); });
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
    if (report.walk() != reports.front().walk()) {
      // Labels of other frames have another fingerprint: only the words can be compared.
      if (words_of_recording(report) != words_of_recording(reports.front()))
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
  // What each may be called, the best first; the last tells every report apart.
  std::vector<std::vector<std::string>> choices;
  for (size_t r = 0; r < reports.size(); ++r) {
    const std::string stem = std::filesystem::path(paths[r]).stem().string();
    if (reports[r].name)
      choices.push_back(
          {*reports[r].name, *reports[r].name, fmt::format("{} ({})", *reports[r].name, r + 1)});
    else
      choices.push_back({reports[r].method, stem, fmt::format("{} ({})", stem, r + 1)});
  }
  std::vector<size_t> chosen(reports.size(), 0);
  const auto clashes = [&](size_t r) {
    for (size_t other = 0; other < reports.size(); ++other)
      if (other != r && choices[other][chosen[other]] == choices[r][chosen[r]] &&
          (reports[other].name || !reports[r].name))  // a user's name makes way for another only
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
      {"schema", "vpr.comparison/1"}, {"query", comparison.query()}, {"reports", Json::array()}};
  for (size_t r = 0; r < comparison.reports.size(); ++r)
    json["reports"].push_back(named_report_json(comparison, r));
  json["ground_truths"] = enum_name(compare_ground_truths(comparison.reports));
  json["queries"] = {
      {"common", found.common}, {"with_match", found.judged}, {"disputed", found.disputed}};
  json["bootstrap"] = {
      {"block", found.block}, {"resamples", comparison.resamples}, {"confidence", 0.95}};
  json["metrics"] = Json::array();
  for (const ComparedValue& value : found.values)
    json["metrics"].push_back({{"metric", value.key},
                               {"report", comparison.names[value.method]},
                               {"value", or_null(value.value)},
                               {"difference", or_null(value.difference)},
                               {"low", value.interval ? Json(value.interval->low) : Json()},
                               {"high", value.interval ? Json(value.interval->high) : Json()}});
  json["paired"] = Json::array();
  for (size_t r = 1; r < comparison.reports.size(); ++r) {
    if (!comparison.is_paired(r)) continue;
    const PairedCounts& counts = found.paired[r];
    json["paired"].push_back({{"report", comparison.names[r]},
                              {"both_right", counts.both_right},
                              {"only_this", counts.only_this},
                              {"only_first", counts.only_first},
                              {"neither", counts.neither}});
  }
  json["protocol"] = {
      {"queries",
       "query frames that all reports judge (neither unreadable nor ignored, and within reach of "
       "every report's windows); a report of another walk, as of a replay, is not paired, and "
       "measured over its own"},
      {"localization",
       "share of all frames of the path with a right fix, frames with a wrong fix, and most frames "
       "in a row without a right fix, as the reports say"},
      {"oracle",
       "fixes of a report with an oracle threshold are best matches up to a threshold that was "
       "chosen from the ground truth"},
      {"confidence", "what AP, R@100P, max F1 and curves accept best matches by"},
      {"disputed", "query frames left out, of which only some ground truths have a match"},
      {"metrics", "of best matches; those of queries without a match are incorrect where accepted"},
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
      // Neither an easier walk nor the ground truth's own threshold makes a better method.
      const bool is_of_path = metric.of_path != nullptr;
      if (!comparison.is_paired(r) || (is_of_path && reports[r].is_oracle != all_oracle))
        values.back() = {};
    }
    if (metric.key != "wrong")  // none are wrong of none
      mark_best(table, table.columns.size(), values, metric.is_low_good);
    table.columns.push_back(k > 0 ? fmt::format("{}{}", metric.symbol, k)
                                  : std::string(metric.symbol));
  }
  bool has_notes = false;
  for (size_t r = 0; r < reports.size(); ++r) {
    table.rows[r].push_back(note_of(comparison, r));
    has_notes = has_notes || !table.rows[r].back().empty();
  }
  if (has_notes)
    table.columns.emplace_back("note");
  else
    for (auto& row : table.rows) row.pop_back();
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
    const auto& interval = value.interval;
    table.rows.push_back({value.key, comparison.names[value.method],
                          metric_cell(*value.metric, value.value), signed_number(value.difference),
                          signed_number(interval ? Value(interval->low) : std::nullopt),
                          signed_number(interval ? Value(interval->high) : std::nullopt),
                          judgment_of(value)});
  }
  return table;
}

Table paired_table(const ComparisonReport& comparison) {
  Table table;
  table.title = fmt::format("Best matches beside those of {}", comparison.names.front());
  table.columns = {"of", "both right", "only this", "only the first", "neither"};
  for (size_t r = 1; r < comparison.reports.size(); ++r) {
    if (!comparison.is_paired(r)) continue;
    const PairedCounts& counts = comparison.found.paired[r];
    table.rows.push_back({comparison.names[r], std::to_string(counts.both_right),
                          std::to_string(counts.only_this), std::to_string(counts.only_first),
                          std::to_string(counts.neither)});
  }
  return table;
}

Table comparison_rows(const ComparisonReport& comparison) {
  const auto text = [](const Metric& metric, Value value) {
    return value ? number_json(metric, value).dump() : "";
  };
  const std::string truths(enum_name(compare_ground_truths(comparison.reports)));
  Table table;
  table.columns = {"query", "report",     "walk", "ground_truths", "metric",
                   "value", "difference", "low",  "high",          "verdict"};
  for (size_t r = 0; r < comparison.reports.size(); ++r) {
    const Report& report = comparison.reports[r];
    const std::vector<std::string> begin = {comparison.query(), comparison.names[r], report.walk(),
                                            truths};
    const auto add = [&](std::vector<std::string> cells) {
      cells.insert(cells.begin(), begin.begin(), begin.end());
      table.rows.push_back(std::move(cells));
    };
    for (const ComparedValue& value : comparison.found.values) {
      if (value.method != r) continue;
      const Metric& metric = *value.metric;
      const auto& interval = value.interval;
      add({value.key, text(metric, value.value), text(metric, value.difference),
           text(metric, interval ? Value(interval->low) : std::nullopt),
           text(metric, interval ? Value(interval->high) : std::nullopt), judgment_of(value)});
    }
    for (const std::string_view key : kPathKeys)
      add({std::string(key), text(find_metric(key), path_value(report, key)), "", "", "", ""});
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
  std::vector<std::string> entries = names;
  for (size_t r = 0; r < reports.size(); ++r)
    entries[r] +=
        fmt::format(" ({}{})", counted(judged_queries(reports[r].outcomes), "query", "queries"),
                    reports[r].outcomes.confidence == Confidence::margin ? ", by margin" : "");
  return "<div class=\"charts\"><figure><figcaption>Precision and recall of best matches, each "
         "over its own queries</figcaption>" +
         page_svg(curves) + "<p class=\"legend\">" + legend_html(entries) +
         "</p></figure></div>\n<h3>Along the path</h3><p class=\"legend\">" +
         legend_html(meanings_of(lanes)) + "</p>" + scroll_begin(html_escaped(title)) +
         page_svg(lanes) + "</div>\n";
}

void draw_comparison(const ComparisonReport& comparison, const std::filesystem::path& folder) {
  const std::string title = title_of(comparison);
  draw_chart(curves_overlay(title, comparison.reports, comparison.names), folder);
  draw_chart(lanes_chart(title, comparison.reports, comparison.names), folder);
}

}  // namespace vpr
