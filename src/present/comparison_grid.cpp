#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.h"
#include "base/text.h"
#include "files/report.h"
#include "present/comparison_report.h"
#include "present/html_page.h"
#include "present/report_tables.h"
#include "present/summary.h"

namespace vpr {
namespace {

using Value = std::optional<double>;

/// A share of the frames with a match, which are the same for all methods on a query, or for a
/// number of frames, of all query frames.
struct GridMetric {
  MetricAt measure;
  std::string_view name;
  std::string_view title;

  const Metric& row() const { return *measure.metric; }
  bool is_of_path() const { return row().of_path.has_value(); }  ///< not of best matches
  bool is_count() const { return row().digits == 0; }
  uint64_t frames_of(const Report& report) const {
    return is_count() ? report.localization.frames : report.counts.best_match.frames;
  }
};

const std::vector<GridMetric>& grid_metrics() {
  static const std::vector<GridMetric> metrics = {
      {metric_at("recall_at", 1), "R@1", "R@1: frames with a correct best match"},
      {metric_at("average_precision"), "AP", "AP of best matches"},
      {metric_at("recall_at_100_precision"), "R@100P", "R@100P of best matches"},
      {metric_at("share"), "recognized correctly", "Share of frames that are recognized correctly"},
      {metric_at("incorrect"), "incorrectly", "Share of frames that are recognized incorrectly"}};
  return metrics;
}

/// A number of frames as their share.
Value value_of(const Report& report, const GridMetric& metric) {
  const Value value = value_of(report, metric.measure);
  if (!value || !metric.is_count()) return value;
  const auto frames = static_cast<double>(metric.frames_of(report));
  return frames > 0 ? Value(*value / frames) : std::nullopt;
}

/// "0.9950 (199 of 200)".
std::string cell_text(const Report& report, const GridMetric& metric) {
  const Value value = value_of(report, metric);
  if (!value) return "-";
  std::string text = fmt::format("{:.4f}", *value);
  const uint64_t frames = metric.frames_of(report);
  if (metric.row().is_share || metric.is_count())
    text += fmt::format(" ({} of {}{})", std::llround(*value * static_cast<double>(frames)), frames,
                        metric.is_of_path() && report.is_oracle ? ", oracle" : "");
  return text;
}

/// Different values in order of first occurrence.
std::vector<std::string> distinct(std::span<const Report> reports, std::string Report::*member) {
  std::vector<std::string> found;
  for (const Report& report : reports)
    if (std::ranges::find(found, report.*member) == found.end()) found.push_back(report.*member);
  return found;
}

/// Null if the method has no report on the query.
const Report* report_of(std::span<const Report> reports, const std::string& method,
                        const std::string& query) {
  const auto found = std::ranges::find_if(reports, [&](const Report& report) {
    return report.row_name == method && report.query == query;
  });
  return found == reports.end() ? nullptr : &*found;
}

// None if a value is unknown.
Value mean_of(const std::vector<Value>& values) {
  double sum = 0;
  for (const Value& value : values) {
    if (!value) return std::nullopt;
    sum += *value;
  }
  return sum / static_cast<double>(values.size());
}

Table grid_table(std::span<const Report> reports, const GridMetric& metric) {
  Table table;
  const bool all_oracle = std::ranges::all_of(reports, &Report::is_oracle);
  const bool any_oracle = std::ranges::any_of(reports, &Report::is_oracle);
  table.title = fmt::format(
      "{} (over all {}{})", metric.title,
      metric.is_count() ? "query frames" : "frames with a match",
      metric.is_of_path() && any_oracle ? "; oracle: threshold chosen from the ground truth" : "");
  const std::vector<std::string> queries = distinct(reports, &Report::query);
  table.columns = {"method"};
  table.columns.insert(table.columns.end(), queries.begin(), queries.end());
  if (queries.size() > 1) table.columns.emplace_back("mean");
  std::vector<std::vector<Value>> columns(table.columns.size() - 1);  // values that may be best
  for (const std::string& method : distinct(reports, &Report::row_name)) {
    std::vector<Value> values;
    auto& cells = table.rows.emplace_back(std::vector{method});
    bool may_be_best = true;
    for (const std::string& query : queries) {
      const Report* report = report_of(reports, method, query);
      values.push_back(report != nullptr ? value_of(*report, metric) : std::nullopt);
      cells.push_back(report != nullptr ? cell_text(*report, metric) : "-");
      // A threshold from the ground truth does not make a better method.
      if (report != nullptr && metric.is_of_path() && report->is_oracle && !all_oracle)
        may_be_best = false;
    }
    if (queries.size() > 1) {
      values.push_back(mean_of(values));
      cells.push_back(values.back() ? fmt::format("{:.4f}", *values.back()) : "-");
    }
    for (size_t c = 0; c < columns.size(); ++c)
      columns[c].push_back(may_be_best ? values[c] : std::nullopt);
  }
  if (!metric.row().is_low_good && table.rows.size() > 1 && !lack_labels(reports))
    for (size_t c = 0; c < columns.size(); ++c) mark_best(table, c + 1, columns[c], false);
  return table;
}

/// One row per method on this query, and one column per metric.
Table query_table(std::span<const Report> reports, const std::string& query) {
  Table table{"Over all frames with a match; incorrectly: over all query frames", {"method"}, {}};
  for (const std::string& method : distinct(reports, &Report::row_name))
    if (report_of(reports, method, query) != nullptr) table.rows.push_back({method});
  for (const GridMetric& metric : grid_metrics()) {
    std::vector<Value> values;
    for (auto& row : table.rows) {
      const Report& report = *report_of(reports, row.front(), query);
      row.push_back(cell_text(report, metric));
      values.push_back(metric.is_of_path() && report.is_oracle ? std::nullopt
                                                               : value_of(report, metric));
    }
    if (!metric.row().is_low_good && table.rows.size() > 1 && !lack_labels(reports))
      mark_best(table, table.columns.size(), values, false);
    table.columns.emplace_back(metric.name);
  }
  return table;
}

std::string query_section(std::span<const Report> reports, const std::string& query) {
  std::vector<Report> of_query;
  for (const Report& report : reports)
    if (report.query == query) of_query.push_back(report);
  const std::string& truth = of_query.front().protocol.ground_truth;
  return section_html(query, "<p class=\"note\">" + html_escaped("Ground truth: " + truth) +
                                 "</p>" + methods_html(of_query) +
                                 table_html(query_table(reports, query)));
}

std::string sentence_of(std::span<const Report> reports) {
  const size_t methods = distinct(reports, &Report::row_name).size();
  const size_t queries = distinct(reports, &Report::query).size();
  const Table table = grid_table(reports, grid_metrics().front());
  std::vector<std::string> best;
  for (const auto& [row, column] : table.best)
    if (column + 1 == table.columns.size())
      best.push_back(fmt::format("{}, {}{}", table.rows[row][0],
                                 queries > 1 ? "a mean R@1 of " : "R@1 ", table.rows[row][column]));
  return fmt::format(
      "{} on {}{}.", counted(methods, "method"), counted(queries, "query", "queries"),
      best.empty() ? "" : fmt::format("; most best matches correct: {}", fmt::join(best, "; ")));
}

}  // namespace

std::string grid_name(const Report& report) {
  if (report.name) return *report.name;
  std::string name = report.method;
  if (const auto window = title_window(report))
    name += fmt::format(", {} {}", window->first, window->second);
  if (const std::string_view score = title_score(report); !score.empty())
    name += fmt::format(", {}", score);
  if (report.selection.selected_fps > 0)
    name += fmt::format(", {} frames per second", report.selection.selected_fps);
  if (!report.selection.speed.empty()) name += ", speed " + report.selection.speed;
  return name;
}

std::vector<Table> grid_tables(std::span<const Report> reports) {
  std::vector<Table> tables;
  for (const GridMetric& metric : grid_metrics()) tables.push_back(grid_table(reports, metric));
  return tables;
}

Table grid_rows(std::span<const Report> reports) {
  Table table{"", {"method", "query", "metric", "value", "frames", "oracle"}, {}};
  for (const Report& report : reports)
    for (const GridMetric& metric : grid_metrics()) {
      const Value value = value_of(report, metric.measure);
      add_row(table, report.row_name, report.query, metric.measure.key(),
              value ? fmt::format("{}", *value) : "", metric.frames_of(report),
              metric.is_of_path() && report.is_oracle ? "yes" : "no");
    }
  return table;
}

std::string grid_page(const std::string& title, std::span<const Report> reports) {
  const std::vector<std::string> queries = distinct(reports, &Report::query);
  std::string sections;
  for (const std::string& query : queries) sections += query_section(reports, query);
  if (queries.size() > 1) {
    const std::vector<Table> tables = grid_tables(reports);
    std::string others;
    for (size_t t = 1; t < tables.size(); ++t) others += table_html(tables[t]);
    sections +=
        section_html("All queries", table_html(tables[0]) + folded_html("Other metrics", others));
  }
  Json first = report_json(reports.front());
  first["protocol"].erase("ground_truth");
  return sections_page(title, sentence_of(reports), "The best value of each column is bold.",
                       sections, first["protocol"], first["provenance"]);
}

}  // namespace vpr
