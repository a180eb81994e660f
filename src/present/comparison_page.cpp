#include "present/comparison_page.h"

#include <algorithm>
#include <array>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.h"
#include "present/comparison_report.h"
#include "present/evaluation_charts.h"
#include "present/html_page.h"
#include "present/metrics_report.h"

namespace vpr {
namespace {

constexpr double kLaneGap = 0.15;  // on both sides of a lane that is 1 high
constexpr double kLaneHeight = 34;

std::optional<Meaning> meaning_of(char fix) {
  return fix == 'r'   ? std::optional(Meaning::right)
         : fix == 'w' ? std::optional(Meaning::wrong)
         : fix == 'i' ? std::optional(Meaning::unjudged)
                      : std::nullopt;
}

// Adds a box for each run of frames with the same fix, in the lane that is `row` lanes from the
// top.
void add_lane(std::vector<Series>& series, const std::string& fixes, size_t row) {
  for (size_t begin = 0; begin < fixes.size();) {
    const size_t end = std::min(fixes.find_first_not_of(fixes[begin], begin), fixes.size());
    if (const auto meaning = meaning_of(fixes[begin])) {
      Series& boxes = *std::ranges::find(series, meaning, &Series::meaning);
      boxes.points.emplace_back(begin, static_cast<double>(row + 1) - kLaneGap);
      boxes.points.emplace_back(end, static_cast<double>(row) + kLaneGap);
    }
    begin = end;
  }
}

std::string title_of(const Json& comparison) {
  return fmt::format("{} on {}", counted(comparison["reports"].size(), "method"),
                     comparison["query"].get<std::string>());
}

// "Best matches of the 51 common queries are right in 80.4 % by mine, 61.8 % by theirs."
std::string sentence_of(const Json& comparison) {
  std::string text;
  for (const Json& row : comparison["metrics"])
    if (row["metric"] == "recall_at_1" && !row["value"].is_null())
      text += fmt::format("{}{:.1f} % by {}",
                          text.empty()
                              ? fmt::format("Best matches of the {} common queries are right in ",
                                            comparison["queries"]["with_match"].dump())
                              : ", ",
                          100 * row["value"].get<double>(), row["report"].get<std::string>());
  return text.empty() ? "The queries have nothing to find." : text + ".";
}

std::string section(const std::string& title, const std::string& content) {
  return "<section><h2>" + title + "</h2>" + content + "</section>\n";
}

/// Precision against recall of best matches, one curve per report over its own queries. Reports
/// without a query to find have no curve.
Chart curves_overlay(const std::string& title, std::span<const StoredReport> reports,
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
Chart lanes_chart(const std::string& title, std::span<const StoredReport> reports,
                  const std::vector<std::string>& names) {
  Chart chart{"lanes", title, {"query frame"}};
  for (const Meaning meaning : {Meaning::unjudged, Meaning::wrong, Meaning::right})
    chart.series.push_back(series_of(meaning, SeriesStyle::boxes));
  size_t frames = 1;
  for (size_t r = 0; r < reports.size(); ++r) {
    add_lane(chart.series, reports[r].fixes, r);
    frames = std::max(frames, reports[r].fixes.size());
    chart.y.ticks.push_back({static_cast<double>(r) + 0.5, names[r]});
  }
  std::erase_if(chart.series, [](const Series& series) { return series.points.empty(); });
  chart.x.range = {0, static_cast<double>(frames)};
  chart.y.range = {static_cast<double>(reports.size()), 0};
  chart.width = 1000;
  chart.height = 130 + kLaneHeight * static_cast<double>(reports.size());
  return chart;
}

/// Curves and paths of all reports, as a part of a page.
std::string methods_html(const std::string& title, std::span<const StoredReport> reports,
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

using Value = std::optional<double>;

/// A number per report: a share of frames, of all methods over the same frames.
struct GridMetric {
  std::string_view key;
  std::string_view title;
  std::string_view pointer;  ///< a count, or a share of the report's own queries
  bool is_count = false;
  bool is_of_path = false;  ///< of all frames; otherwise of those with a match
  bool has_best = true;
};

constexpr std::array<GridMetric, 5> kMetrics = {
    {{"recall_at_1", "R@1: frames with a right best match", "/best_match/correct", true},
     {"average_precision", "AP of best matches", "/metrics/single_best/average_precision"},
     {"recall_at_100_precision", "R@100P of best matches",
      "/metrics/single_best/recall_at_100_precision"},
     {"share", "Share of the path with a right fix", "/localisation/right", true, true},
     {"wrong", "Share of the path with a wrong fix", "/localisation/wrong", true, true, false}}};

double number_at(const Json& report, std::string_view pointer) {
  return report.value(Json::json_pointer(std::string(pointer)), 0.0);
}

/// Frames that a report's shares are of: all, or those with a match. Without a window, a frame is
/// not right; one whose best match is to be ignored is left out.
double frames_of(const Json& report, const GridMetric& metric) {
  if (metric.is_of_path) return number_at(report, "/localisation/frames");
  return number_at(report, "/localisation/frames_with_match") -
         number_at(report, "/best_match/ignored");
}

Value value_of(const Json& report, const GridMetric& metric) {
  const Json::json_pointer pointer{std::string(metric.pointer)};
  const double frames = frames_of(report, metric);
  if (!report.contains(pointer) || !report[pointer].is_number() || frames <= 0) return {};
  const double own = metric.is_count ? 1 : number_at(report, "/metrics/single_best/to_find");
  return report[pointer].get<double>() * own / frames;
}

bool is_oracle(const Json& report) { return report.contains("oracle"); }

/// "0.9950 (199 of 200)".
std::string cell_text(const Json& report, const GridMetric& metric) {
  const Value value = value_of(report, metric);
  if (!value) return "-";
  std::string text = fmt::format("{:.4f}", *value);
  if (metric.is_count)
    text += fmt::format(" ({:.0f} of {:.0f}{})", number_at(report, metric.pointer),
                        frames_of(report, metric),
                        metric.is_of_path && is_oracle(report) ? ", oracle" : "");
  return text;
}

/// Texts in the order in which they first occur.
std::vector<std::string> distinct(std::span<const GridReport> reports,
                                  std::string GridReport::*field) {
  std::vector<std::string> found;
  for (const GridReport& report : reports)
    if (std::ranges::find(found, report.*field) == found.end()) found.push_back(report.*field);
  return found;
}

/// None where the method was not run on the query.
const Json* report_of(std::span<const GridReport> reports, const std::string& method,
                      const std::string& query) {
  const auto found = std::ranges::find_if(reports, [&](const GridReport& report) {
    return report.method == method && report.query == query;
  });
  return found == reports.end() ? nullptr : &found->report;
}

// Of a method that has them all.
Value mean_of(const std::vector<Value>& values) {
  double sum = 0;
  for (const Value& value : values) {
    if (!value) return std::nullopt;
    sum += *value;
  }
  return sum / static_cast<double>(values.size());
}

void mark_best(Table& table, const std::vector<std::vector<Value>>& rows) {
  for (size_t column = 0; rows.size() > 1 && column < rows[0].size(); ++column) {
    Value best;
    for (const auto& row : rows)
      if (row[column] && (!best || *row[column] > *best)) best = row[column];
    for (size_t r = 0; r < rows.size(); ++r)
      if (best && rows[r][column] == best) table.best.insert({r, column + 1});
  }
}

Table grid_table(std::span<const GridReport> reports, const GridMetric& metric) {
  Table table;
  const auto oracle = [](const GridReport& report) { return report.stored.is_oracle; };
  const bool all_oracle = std::ranges::all_of(reports, oracle);
  const bool any_oracle = std::ranges::any_of(reports, oracle);
  table.title = fmt::format(
      "{} (over all frames of the query{}{})", metric.title,
      metric.is_of_path ? "" : " that have a match",
      metric.is_of_path && any_oracle ? "; oracle: threshold chosen from the ground truth" : "");
  const std::vector<std::string> queries = distinct(reports, &GridReport::query);
  table.columns = {"method"};
  table.columns.insert(table.columns.end(), queries.begin(), queries.end());
  if (queries.size() > 1) table.columns.emplace_back("mean");
  std::vector<std::vector<Value>> rows;
  for (const std::string& method : distinct(reports, &GridReport::method)) {
    auto& values = rows.emplace_back();
    auto& cells = table.rows.emplace_back(std::vector{method});
    bool may_be_best = true;
    for (const std::string& query : queries) {
      const Json* report = report_of(reports, method, query);
      values.push_back(report != nullptr ? value_of(*report, metric) : std::nullopt);
      cells.push_back(report != nullptr ? cell_text(*report, metric) : "-");
      // The ground truth's own threshold makes no better method.
      if (report != nullptr && metric.is_of_path && is_oracle(*report) && !all_oracle)
        may_be_best = false;
    }
    if (queries.size() > 1) {
      values.push_back(mean_of(values));
      cells.push_back(values.back() ? fmt::format("{:.4f}", *values.back()) : "-");
    }
    if (!may_be_best) values.assign(values.size(), std::nullopt);
  }
  if (metric.has_best) mark_best(table, rows);
  return table;
}

std::string query_section(std::span<const GridReport> reports, const std::string& query) {
  std::vector<StoredReport> stored;
  std::vector<std::string> names;
  for (const GridReport& report : reports) {
    if (report.query != query) continue;
    stored.push_back(report.stored);
    names.push_back(report.method);
  }
  const std::string& truth = stored.front().ground_truth;
  return section(html_escaped(query), "<p class=\"note\">" +
                                          html_escaped("Ground truth: " + truth) + "</p>" +
                                          methods_html(query, stored, names));
}

std::string sentence_of(std::span<const GridReport> reports) {
  const size_t methods = distinct(reports, &GridReport::method).size();
  const size_t queries = distinct(reports, &GridReport::query).size();
  const Table table = grid_table(reports, kMetrics[0]);
  std::vector<std::string> best;
  for (const auto& [row, column] : table.best)
    if (column + 1 == table.columns.size())
      best.push_back(fmt::format("{}, {}{}", table.rows[row][0],
                                 queries > 1 ? "a mean R@1 of " : "R@1 ", table.rows[row][column]));
  return fmt::format(
      "{} on {}{}.", counted(methods, "method"), counted(queries, "query", "queries"),
      best.empty() ? "" : fmt::format("; the most best matches right: {}", fmt::join(best, "; ")));
}

}  // namespace

std::string comparison_page(const Json& comparison, std::span<const StoredReport> reports,
                            const std::vector<std::string>& names) {
  const std::string title = title_of(comparison);
  Json made = comparison["bootstrap"];
  made.update(comparison["provenance"]);
  const std::string sections = section("Numbers", table_html(paper_table(comparison))) +
                               section("Curves and paths", methods_html(title, reports, names)) +
                               section("Differences", table_html(comparison_table(comparison)) +
                                                          table_html(paired_table(comparison)));
  return sections_page(title, sentence_of(comparison),
                       "Ground truth: " + reports.front().ground_truth, sections,
                       comparison["protocol"], made);
}

void draw_comparison(const Json& comparison, std::span<const StoredReport> reports,
                     const std::vector<std::string>& names, const std::filesystem::path& folder) {
  const std::string title = title_of(comparison);
  draw_chart(curves_overlay(title, reports, names), folder);
  draw_chart(lanes_chart(title, reports, names), folder);
}

std::string grid_name(const Json& report) {
  if (report.contains("name")) return report["name"].get<std::string>();
  std::string name = report["method"].get<std::string>();
  const Json& settings = report["settings"];
  for (const char* key : {"c_l", "c_w", "window"})
    if (settings.contains(key)) name += fmt::format(", {} {}", key, settings[key].dump());
  if (settings.contains("score") && settings["score"].is_string())
    name += ", " + settings["score"].get<std::string>();
  if (report.contains("thinned"))
    name += fmt::format(", {} frames a second", report["thinned"]["fps"].get<double>());
  if (report.contains("warp")) name += ", replayed: " + report["warp"]["name"].get<std::string>();
  return name;
}

std::vector<Table> grid_tables(std::span<const GridReport> reports) {
  std::vector<Table> tables;
  for (const GridMetric& metric : kMetrics) tables.push_back(grid_table(reports, metric));
  return tables;
}

Table grid_rows(std::span<const GridReport> reports) {
  Table table{"", {"method", "query", "metric", "value", "frames", "oracle"}, {}};
  for (const GridReport& report : reports)
    for (const GridMetric& metric : kMetrics) {
      const Value value = value_of(report.report, metric);
      table.rows.push_back({report.method, report.query, std::string(metric.key),
                            value ? fmt::format("{}", *value) : "",
                            fmt::format("{}", frames_of(report.report, metric)),
                            metric.is_of_path && is_oracle(report.report) ? "yes" : "no"});
    }
  return table;
}

std::string grid_page(const std::string& title, std::span<const GridReport> reports) {
  std::string tables;
  for (const Table& table : grid_tables(reports)) tables += table_html(table);
  std::string sections = section("Numbers", tables);
  for (const std::string& query : distinct(reports, &GridReport::query))
    sections += query_section(reports, query);
  const Json& first = reports.front().report;
  Json protocol = first["protocol"];
  protocol.erase("ground_truth");
  return sections_page(title, sentence_of(reports),
                       "Rows are methods, columns queries; the best of each is bold.", sections,
                       protocol, first["provenance"]);
}

}  // namespace vpr
