// The tables of a report, from its JSON.
#include <fmt/format.h>

#include "base/json.h"
#include "base/text.h"
#include "evaluation/metrics.h"
#include "report/metrics_report.h"

namespace vpr {
namespace {

std::string shown(const Json& value, int digits) {
  if (value.is_null()) return "-";
  if (value.is_number_integer()) return value.dump();
  return fmt::format("{:.{}f}", value.get<double>(), digits);
}

std::vector<std::string> metric_cells(const Json& mode) {
  std::vector<std::string> cells;
  for (const CurveMetric& metric : curve_metrics())
    cells.push_back(shown(mode.value(std::string(metric.key), Json()), 4));
  return cells;
}

Table curve_table(const Json& report) {
  const Json& best = report["best_match"];
  const Json& metrics = report["metrics"];
  Table table;
  table.title = fmt::format(
      "Metrics ({} with a match; {} without one, wrong if accepted{}; {} ignored, {} "
      "unreadable, left out{})",
      counted(best["queries"].get<uint64_t>(), "query", "queries"), best["without_match"].dump(),
      best["unreachable"] == 0
          ? ""
          : fmt::format("; {} whose place lies where no training window ends, likewise",
                        best["unreachable"].dump()),
      best["ignored"].dump(), best["unreadable"].dump(),
      metrics["single_best"].contains("tied_queries")
          ? fmt::format("; {} tied, to the first", metrics["single_best"]["tied_queries"].dump())
          : "");
  table.columns = {"of", "to find"};
  for (const CurveMetric& metric : curve_metrics()) table.columns.emplace_back(metric.column);
  const auto add = [&](const std::string& name, const Json& mode) {
    table.rows.push_back({name, mode["to_find"].dump()});
    for (std::string& cell : metric_cells(mode)) table.rows.back().push_back(std::move(cell));
  };
  const bool by_margin = report.contains("confidence");
  add(by_margin ? "best matches, by margin" : "best matches", metrics["single_best"]);
  for (const auto& [key, name] :
       {std::pair("by_margin", "the same by margin"), std::pair("by_score", "the same by score")})
    if (metrics.contains(key)) add(name, metrics[key]);
  if (metrics.contains("all_pairs")) add("all pairs", metrics["all_pairs"]);
  return table;
}

// A column for each value, in the first row; `prefix` goes before its key.
void add_values(Table& table, const std::string& prefix, const Json& values) {
  for (const auto& item : values.items()) {
    table.columns.push_back(prefix + item.key());
    table.rows[0].push_back(shown(item.value(), 4));
  }
}

Table recall_table(const Json& report) {
  Table table;
  table.title =
      "Recall@K (queries with a match; ties to the first; ignored references passed over)";
  table.rows.emplace_back();
  add_values(table, "R@", report["metrics"]["recall_at"]);
  return table;
}

// Of reports of older date, which have none, no columns.
Table ranking_table(const Json& report) {
  const Json& metrics = report["metrics"];
  Table table;
  table.title =
      "Precision@K and mAP@K (queries with a match; ties to the first; ignored references passed "
      "over)";
  table.rows.emplace_back();
  for (const auto& [key, name] : {std::pair("precision_at", "P@"), std::pair("map_at", "mAP@")})
    if (metrics.contains(key)) add_values(table, name, metrics[key]);
  return table;
}

Table achievement_table(const Json& report) {
  const Json found = report["metrics"].value("recall_achievement", Json::object());
  Table table;
  table.rows.emplace_back();
  if (found.empty()) return table;
  table.title = fmt::format(
      "Recall achievement rate (share of {} of about {} whose recall@1 reaches the target)",
      counted(found["stretches"].get<uint64_t>(), "stretch", "stretches"),
      counted(found["stretch_frames"].get<uint64_t>(), "frame"));
  add_values(table, "RAR ", found["targets"]);
  return table;
}

Table localisation_table(const Json& report) {
  const Json& found = report["localisation"];
  Table table;
  table.title =
      fmt::format("Along the path ({})", report["protocol"].value("localisation", std::string()));
  table.columns = {"frames", "right", "wrong", "share", "longest gap", "first fix"};
  table.rows = {{found["frames"].dump(), found["right"].dump(), found["wrong"].dump(),
                 shown(found["share"], 4), found["longest_gap_frames"].dump(),
                 shown(found["first_fix_frames"], 0)}};
  if (found["longest_gap_m"].is_null()) return table;
  table.columns.insert(table.columns.end(), {"longest gap m", "first fix m"});
  table.rows[0].push_back(shown(found["longest_gap_m"], 2));
  table.rows[0].push_back(shown(found["first_fix_m"], 2));
  return table;
}

}  // namespace

std::vector<Table> metrics_tables(const Json& report) {
  std::vector<Table> tables = {curve_table(report)};
  if (report["metrics"]["recall_at"].size() > 1) tables.push_back(recall_table(report));
  for (const Table& table :
       {ranking_table(report), achievement_table(report), localisation_table(report)})
    if (!table.columns.empty()) tables.push_back(table);
  return tables;
}

void append_metrics(Table& table, const Json& report) {
  const auto add = [&](const std::string& column, const std::string& value) {
    table.columns.push_back(column);
    table.rows.front().push_back(value);
  };
  for (const auto& [key, name] :
       {std::pair("single_best", "best"), std::pair("by_margin", "margin"),
        std::pair("by_score", "score"), std::pair("all_pairs", "pairs")}) {
    if (!report["metrics"].contains(key)) continue;
    const std::vector<std::string> cells = metric_cells(report["metrics"][key]);
    for (size_t m = 0; m < cells.size(); ++m)
      add(fmt::format("{} {}", name, curve_metrics()[m].column), cells[m]);
  }
  for (const Table& more : {recall_table(report), ranking_table(report), achievement_table(report),
                            localisation_table(report)})
    for (size_t c = 0; c < more.columns.size(); ++c) add(more.columns[c], more.rows[0][c]);
}

}  // namespace vpr
