#include "present/methods_table.h"

#include <algorithm>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.h"
#include "base/text.h"
#include "evaluate/metrics.h"
#include "present/report_tables.h"
#include "present/summary.h"

namespace vpr {
namespace {

using Value = std::optional<double>;

bool has_incorrect_pairs(const Report& report) {
  return report.query_settings() != nullptr && !report.has_paths() &&
         report.counts.recognitions.incorrect > 0;
}

// A threshold from the ground truth recognizes nothing, and scores have no accepted pairs.
Value shown_value(const Report& report, const MetricAt& at) {
  if (at.metric->of_path && report.frames.is_oracle) return std::nullopt;
  if (at.metric->of_counts && report.query_settings() == nullptr) return std::nullopt;
  return value_of(report, at);
}

std::string data_cell(const Metric& metric, Value value) {
  if (!value) return "";
  return metric.digits == 0 ? fmt::format("{}", static_cast<uint64_t>(*value)) : to_line(*value);
}

// "412 of 639".
std::string pairs_cell(const Report& report) {
  if (report.query_settings() == nullptr || report.has_paths()) return "-";
  const LabelCounts& pairs = report.counts.recognitions;
  return fmt::format("{} of {}", pairs.incorrect, pairs.all());
}

// The metric with each K, or each verdict that tables of this detail have.
std::vector<MetricAt> columns_of(const Metric& metric, const SideBySide& methods,
                                 TableDetail detail) {
  const std::span<const Report> reports = methods.reports;
  const bool has_other_columns = metric.is_percent || metric.of_stretches != nullptr;
  if (metric.detail > detail || metric.symbol.empty() || has_other_columns) return {};
  if (metric.has_verdicts()) {
    if (detail == TableDetail::data)
      return {{&metric, 0, &LabelCounts::correct},
              {&metric, 0, &LabelCounts::incorrect},
              {&metric, 0, &LabelCounts::ignored}};
    if (std::ranges::none_of(reports, has_incorrect_pairs)) return {};
    return {{&metric, 0, &LabelCounts::incorrect}};
  }
  if (metric.of_query == nullptr) return {{&metric}};
  std::set<size_t> ks;
  for (const Report& report : reports)
    for (const auto& [k, value] :
         report.metrics.ranks[static_cast<size_t>(&metric - rank_metrics().data())])
      ks.insert(k);
  std::vector<MetricAt> columns;
  for (const size_t k : ks)
    if (methods.recall_at.empty() || std::ranges::count(methods.recall_at, k) > 0)
      columns.push_back({&metric, k});
  return columns;
}

/// A table of one row per method that is filled by columns.
struct Columns {
  Table table;
  std::span<const Report> reports;

  /// Adds a column, unless all of its cells are unknown: "-" or empty. Returns whether it did.
  bool add(const std::string& name, const auto& cell_of) {
    std::vector<std::string> cells;
    for (const Report& report : reports) cells.push_back(cell_of(report));
    const auto is_unknown = [](const std::string& cell) { return cell.empty() || cell == "-"; };
    if (std::ranges::all_of(cells, is_unknown)) return false;
    table.columns.push_back(name);
    for (size_t r = 0; r < cells.size(); ++r) table.rows[r].push_back(std::move(cells[r]));
    return true;
  }
};

void add_settings(Columns& columns) {
  std::vector<std::string> symbols;
  for (const Report& report : columns.reports)
    for (const auto& [symbol, value] : settings_of(report))
      if (std::ranges::count(symbols, symbol) == 0) symbols.emplace_back(symbol);
  for (const std::string& symbol : symbols)
    columns.add(symbol, [&](const Report& report) -> std::string {
      for (const auto& [name, value] : settings_of(report))
        if (name == symbol) return value;
      return "";
    });
}

// Metrics of best matches by the other confidence, and of all pairs; recall achievement.
void add_other_data(Columns& columns) {
  const auto add_curves = [&](const std::string& name, auto member) {
    for (size_t m = 0; m < curve_metrics().size(); ++m)
      columns.add(fmt::format("{} {}", curve_metrics()[m].symbol, name), [&](const Report& report) {
        const std::optional<CurveNumbers>& numbers = report.metrics.curves.*member;
        return numbers ? data_cell(curve_metrics()[m], numbers->values[m].value) : "";
      });
  };
  add_curves("by margin", &ByAcceptance<CurveNumbers>::by_margin);
  add_curves("by score", &ByAcceptance<CurveNumbers>::by_score);
  add_curves("of all pairs", &ByAcceptance<CurveNumbers>::all_pairs);
  const Metric& achievement = find_metric("recall_achievement");
  for (const double target : kRecallTargets) {
    const std::string key = fmt::format("{:g}", target);
    columns.add(fmt::format("{}{}", achievement.symbol, key), [&](const Report& report) {
      const auto& reached = report.metrics.recall_achievement.reached;
      const auto found = reached.find(key);
      return found == reached.end() ? "" : data_cell(achievement, found->second);
    });
  }
}

// The value of a report in a comparison; null without one.
const ComparedValue* compared_value(const SideBySide& methods, const MetricAt& at, size_t report) {
  for (const ComparedValue& value : methods.compared)
    if (value.method == report && value.metric == at) return &value;
  return nullptr;
}

void mark_best_methods(Table& table, const SideBySide& methods, const MetricAt& at) {
  if (!methods.compared.empty()) {
    for (size_t r = 0; r < methods.reports.size(); ++r)
      if (const ComparedValue* value = compared_value(methods, at, r); value && value->is_best)
        table.best.insert({r, table.columns.size() - 1});
    return;
  }
  std::vector<Value> values;
  for (size_t r = 0; r < methods.reports.size(); ++r)
    values.push_back(methods.is_comparable[r] ? value_of(methods.reports[r], at) : std::nullopt);
  if (std::ranges::count_if(values, &Value::has_value) > 1)
    mark_best(table, table.columns.size() - 1, values, at.metric->is_low_good);
}

// "corridor: over 111 frames with a match; correct and incorrect: recognized frames".
std::string table_title(const SideBySide& methods, const std::vector<std::string>& columns) {
  const auto has = [&](const char* column) { return std::ranges::count(columns, column) > 0; };
  std::string title = fmt::format("{}: over {}", methods.query, methods.frames);
  if (has("correct")) title += "; correct and incorrect: recognized frames";
  title += off_map_words(methods.reports);
  if (has("longest gap")) title += "; longest gap in frames";
  return title;
}

}  // namespace

std::string note_of(const Report& report, bool is_comparable, bool differ) {
  std::vector<std::string> notes;
  if (report.selection.is_selected()) notes.push_back(selection_text(report.selection));
  if (!is_comparable)
    notes.push_back(
        fmt::format("over {} of its own", counted(report.counts.best_match.frames, "frame")));
  if (report.frames.is_oracle) notes.emplace_back("threshold from the ground truth");
  if (const std::string caution = caution_of(report); !caution.empty()) notes.push_back(caution);
  if (differ) notes.push_back(report.protocol.ground_truth);
  return fmt::format("{}", fmt::join(notes, "; "));
}

SideBySide side_by_side(std::span<const Report> reports) {
  const Report& first = reports.front();
  const auto is_comparable = [&](const Report& report) {
    return report.provenance.ground_truth == first.provenance.ground_truth;
  };
  const bool differ = !std::ranges::all_of(reports, is_comparable);
  SideBySide methods{reports, first.query, {}, {}, {}, false};
  methods.frames = fmt::format("{} {}", counted(first.counts.best_match.frames, "frame"),
                               first.frames_that_count());
  for (const Report& report : reports) {
    methods.is_comparable.push_back(is_comparable(report));
    methods.notes.push_back(note_of(report, methods.is_comparable.back(), differ));
  }
  return methods;
}

Table methods_table(const SideBySide& methods, TableDetail detail) {
  const std::span<const Report> reports = methods.reports;
  const bool is_data = detail == TableDetail::data;
  Columns columns{{"", {"method"}, {}, {}, "methods", {}}, reports};
  Table& table = columns.table;
  for (const Report& report : reports) table.rows.push_back({report.row_name});
  if (is_data) {
    columns.add("query", [](const Report& report) { return report.query; });
    add_settings(columns);
  }
  if (!is_data && std::ranges::count(methods.is_comparable, false) > 0)
    columns.add("of frames", [](const Report& report) {
      return std::to_string(report.counts.best_match.frames);
    });
  const bool may_mark = !is_data && !lack_labels(reports);
  for (const Metric& metric : metrics())
    for (const MetricAt& at : columns_of(metric, methods, detail)) {
      const char* whole = methods.omits_frames && metric.of_counts ? " (all frames)" : "";
      const bool is_added = columns.add(at.symbol() + whole, [&](const Report& report) {
        const Value value = shown_value(report, at);
        if (is_data) return data_cell(metric, value);
        if (metric.has_verdicts()) return pairs_cell(report);
        const auto r = static_cast<size_t>(&report - reports.data());
        const ComparedValue* compared =
            methods.has_intervals ? compared_value(methods, at, r) : nullptr;
        const bool has_interval = compared != nullptr && compared->own && value;
        return metric_cell(metric, value) +
               (has_interval
                    ? fmt::format(" [{:.3f}, {:.3f}]", compared->own->low, compared->own->high)
                    : "");
      });
      if (is_added && may_mark && (metric.of_curve != nullptr || metric.of_query != nullptr))
        mark_best_methods(table, methods, at);
    }
  if (is_data) add_other_data(columns);
  table.title = table_title(methods, table.columns);
  for (size_t r = 0; r < reports.size(); ++r)
    if (!methods.notes[r].empty())
      table.notes.push_back(fmt::format("{}: {}", reports[r].row_name, methods.notes[r]));
  if (is_data) {
    size_t r = 0;
    columns.add("note", [&](const Report&) { return methods.notes[r++]; });
  }
  return table;
}

TableDetail detail_of(TableFormat format) {
  return format == TableFormat::csv     ? TableDetail::data
         : format == TableFormat::latex ? TableDetail::brief
                                        : TableDetail::full;
}

std::string short_text(Table table, bool is_terminal) {
  const size_t kLongestName = is_terminal ? 22 : std::string::npos;
  for (auto& row : table.rows) {
    if (row[0].size() <= kLongestName) continue;
    row[0] = row[0].substr(0, letter_start(row[0], kLongestName - 3)) + "...";
  }
  const std::string title = wrapped_line(printable_line(std::exchange(table.title, "")), 80, 2);
  return (title.empty() ? "" : title + "\n") + render_table(table, TableFormat::text);
}

}  // namespace vpr
