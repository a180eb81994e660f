#include "present/comparison_report.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.h"
#include "base/text.h"
#include "evaluate/metrics.h"
#include "present/evaluation_report.h"
#include "present/json_fields.h"
#include "present/metrics_report.h"

namespace vpr {
namespace {

std::string signed_number(const Json& value) {
  return value.is_null() ? "-" : fmt::format("{:+.4f}", value.get<double>());
}

bool is_low_good(const std::string& key) {
  const auto metrics = curve_metrics();
  const auto found = std::ranges::find(metrics, key, &CurveMetric::key);
  return found != metrics.end() && found->is_low_good;
}

// Whether the interval leaves chance out.
std::string judgement_of(const Json& row) {
  if (row["low"].is_null()) return "";
  const bool is_higher = row["low"].get<double>() > 0;
  if (!is_higher && row["high"].get<double>() >= 0) return "";
  return is_higher != is_low_good(row["metric"].get<std::string>()) ? "better" : "worse";
}

/// A column of the paper's table.
struct PaperColumn {
  std::string name;
  std::string key;  ///< of a metric, or of the path
  bool is_low_good = false;
  int digits = 4;
  bool is_of_path = false;  ///< of fixes
  bool has_best = true;
};

std::vector<PaperColumn> paper_columns() {
  std::vector<PaperColumn> columns = {
      {"R@1", "recall_at_1"}, {"R@5", "recall_at_5"}, {"R@10", "recall_at_10"}};
  for (const char* key : {"average_precision", "recall_at_100_precision", "max_f1"})
    columns.push_back(
        {std::string(std::ranges::find(curve_metrics(), key, &CurveMetric::key)->column), key});
  columns.push_back({"share", "share", false, 4, true});
  columns.push_back({"wrong", "wrong", true, 0, true, false});  // none are wrong of none
  columns.push_back({"longest gap", "longest_gap_frames", true, 0, true});
  return columns;
}

Json value_of(const Json& comparison, const Json& report, const std::string& key) {
  if (report["localisation"].contains(key)) return report["localisation"][key];
  for (const Json& row : comparison["metrics"])
    if (row["metric"] == key && row["report"] == report["name"]) return row["value"];
  return {};
}

// Marks the best of a column, all that share it; nothing where fewer than two are known.
void mark_best(Table& table, size_t column, const std::vector<Json>& values, bool is_low_good) {
  std::optional<double> best;
  size_t known = 0;
  for (const Json& value : values) {
    if (value.is_null()) continue;
    ++known;
    const double number = value.get<double>();
    if (!best || (is_low_good ? number < *best : number > *best)) best = number;
  }
  for (size_t row = 0; row < values.size() && known > 1; ++row)
    if (!values[row].is_null() && values[row].get<double>() == *best)
      table.best.insert({row, column});
}

std::string note_of(const Json& comparison, const Json& report) {
  std::vector<std::string> notes;
  if (report.contains("walk")) notes.push_back(report["walk"].get<std::string>());
  if (!report["paired"].get<bool>())
    notes.push_back(fmt::format("not paired, over {} of its own",
                                counted(report["queries"].get<uint64_t>(), "query", "queries")));
  if (report["oracle"].get<bool>()) notes.emplace_back("threshold from the ground truth");
  if (comparison["ground_truths"] != "same")
    notes.push_back(report["ground_truth"].get<std::string>());
  return fmt::format("{}", fmt::join(notes, "; "));
}

std::string common_queries(const Json& comparison) {
  const Json& queries = comparison["queries"];
  return fmt::format("{} ({} with a match)",
                     counted(queries["common"].get<uint64_t>(), "common query", "common queries"),
                     queries["with_match"].dump());
}

}  // namespace

Json comparison_json(const Comparison& comparison, const std::vector<StoredReport>& reports,
                     const std::vector<std::string>& names, size_t resamples, const RunInfo& run) {
  const auto named = std::find_if(reports.begin(), reports.end(), [](const StoredReport& report) {
    return report.query != kUnnamedQuery;
  });
  Json json = {{"schema", "vpr.comparison/1"},
               {"query", named == reports.end() ? kUnnamedQuery : named->query}};
  json["reports"] = Json::array();
  for (size_t m = 0; m < reports.size(); ++m) {
    json["reports"].push_back({{"name", names[m]},
                               {"method", reports[m].method},
                               {"ground_truth", reports[m].ground_truth},
                               {"queries", comparison.own[m]},
                               {"paired", is_same_walk(reports[m], reports.front())},
                               {"localisation",
                                {{"share", or_null(reports[m].share)},
                                 {"wrong", reports[m].wrong},
                                 {"longest_gap_frames", reports[m].longest_gap}}},
                               {"oracle", reports[m].is_oracle},
                               {"confidence", enum_name(reports[m].outcomes.confidence)},
                               {"fingerprint", reports[m].fingerprint}});
    if (!reports[m].walk.empty()) json["reports"].back()["walk"] = reports[m].walk;
    json["reports"].back()["ground_truth_fingerprint"] = reports[m].ground_truth_fingerprint;
  }
  json["ground_truths"] = enum_name(compare_ground_truths(reports));
  json["queries"] = {{"common", comparison.common},
                     {"with_match", comparison.judged},
                     {"disputed", comparison.disputed}};
  json["bootstrap"] = {{"block", comparison.block}, {"resamples", resamples}, {"confidence", 0.95}};
  json["metrics"] = Json::array();
  for (const ComparedValue& value : comparison.values)
    json["metrics"].push_back({{"metric", value.metric},
                               {"report", names[value.method]},
                               {"value", or_null(value.value)},
                               {"difference", or_null(value.difference)},
                               {"low", value.interval ? Json(value.interval->low) : Json()},
                               {"high", value.interval ? Json(value.interval->high) : Json()}});
  json["paired"] = Json::array();
  for (size_t m = 1; m < reports.size(); ++m) {
    if (!is_same_walk(reports[m], reports.front())) continue;
    json["paired"].push_back({{"report", names[m]},
                              {"both_right", comparison.paired[m].both_right},
                              {"only_this", comparison.paired[m].only_this},
                              {"only_first", comparison.paired[m].only_first},
                              {"neither", comparison.paired[m].neither}});
  }
  json["protocol"] = {
      {"queries",
       "query frames that all reports judge (neither unreadable nor ignored, and within reach of "
       "every report's windows); a report of another walk, as of a replay, is not paired, and "
       "measured over its own"},
      {"localisation",
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
       "the same blocks of neighbouring queries for all reports"}};
  json["provenance"] = provenance_json(run);
  return json;
}

Table paper_table(const Json& comparison) {
  Table table;
  table.title =
      fmt::format("{}: over {}; share, wrong and longest gap (frames) over the whole path",
                  comparison["query"].get<std::string>(), common_queries(comparison));
  const Json& reports = comparison["reports"];
  const bool all_oracle =
      std::ranges::all_of(reports, [](const Json& report) { return report["oracle"].get<bool>(); });
  table.columns = {"method"};
  for (const Json& report : reports) table.rows.push_back({report["name"].get<std::string>()});
  for (const PaperColumn& column : paper_columns()) {
    std::vector<Json> values;
    for (const Json& report : reports) {
      values.push_back(value_of(comparison, report, column.key));
      const Json& value = values.back();
      table.rows[values.size() - 1].push_back(shown(value, column.digits));
    }
    // Neither an easier walk nor the ground truth's own threshold makes a better method.
    for (size_t m = 0; m < reports.size(); ++m)
      if (!reports[m]["paired"].get<bool>() ||
          (column.is_of_path && reports[m]["oracle"] != all_oracle))
        values[m] = {};
    if (column.has_best) mark_best(table, table.columns.size(), values, column.is_low_good);
    table.columns.push_back(column.name);
  }
  bool has_notes = false;
  for (size_t m = 0; m < reports.size(); ++m) {
    table.rows[m].push_back(note_of(comparison, reports[m]));
    has_notes = has_notes || !table.rows[m].back().empty();
  }
  if (has_notes)
    table.columns.emplace_back("note");
  else
    for (auto& row : table.rows) row.pop_back();
  return table;
}

Table comparison_table(const Json& comparison) {
  Table table;
  table.title = fmt::format("{}: differences to {} over {}, 95 % by blocks of {}",
                            comparison["query"].get<std::string>(),
                            comparison["reports"][0]["name"].get<std::string>(),
                            common_queries(comparison), comparison["bootstrap"]["block"].dump());
  if (comparison["ground_truths"] != "same")
    table.title +=
        fmt::format("; ground truths: {}", comparison["ground_truths"].get<std::string>());
  table.columns = {"metric", "of", "value", "difference", "from", "to", ""};
  for (const Json& row : comparison["metrics"])
    if (!row["value"].is_null())
      table.rows.push_back({row["metric"].get<std::string>(), row["report"].get<std::string>(),
                            shown(row["value"]), signed_number(row["difference"]),
                            signed_number(row["low"]), signed_number(row["high"]),
                            judgement_of(row)});
  return table;
}

Table paired_table(const Json& comparison) {
  Table table;
  table.title = fmt::format("Best matches beside those of {}",
                            comparison["reports"][0]["name"].get<std::string>());
  table.columns = {"of", "both right", "only this", "only the first", "neither"};
  for (const Json& row : comparison["paired"])
    table.rows.push_back({row["report"].get<std::string>(), row["both_right"].dump(),
                          row["only_this"].dump(), row["only_first"].dump(),
                          row["neither"].dump()});
  return table;
}

Table comparison_rows(const Json& comparison) {
  const auto text = [](const Json& value) { return value.is_null() ? "" : value.dump(); };
  Table table;
  table.columns = {"query", "report",     "walk", "ground_truths", "metric",
                   "value", "difference", "low",  "high",          "verdict"};
  const auto begin = [&](const Json& report) {
    table.rows.push_back({comparison["query"].get<std::string>(), report["name"].get<std::string>(),
                          report.value("walk", std::string()),
                          comparison["ground_truths"].get<std::string>()});
  };
  const auto add = [&](std::vector<std::string> cells) {
    for (std::string& cell : cells) table.rows.back().push_back(std::move(cell));
  };
  for (const Json& report : comparison["reports"]) {
    for (const Json& row : comparison["metrics"]) {
      if (row["report"] != report["name"]) continue;
      begin(report);
      add({row["metric"].get<std::string>(), text(row["value"]), text(row["difference"]),
           text(row["low"]), text(row["high"]), judgement_of(row)});
    }
    for (const auto& item : report["localisation"].items()) {
      begin(report);
      add({item.key(), text(item.value()), "", "", "", ""});
    }
  }
  return table;
}

}  // namespace vpr
