#include "report/several_reports.h"

#include <fmt/format.h>

#include "base/json.h"
#include "report/evaluation_report.h"

namespace vpr {
namespace {

void add_run(Json& json, const RunInfo& run, double seconds) {
  json["machine"] = machine_json(run);
  json["timing"] = timing_json({{"evaluate", seconds}});
}

}  // namespace

Json reports_json(const std::vector<Json>& reports, const std::vector<std::string>& names,
                  const RunInfo& run, double seconds) {
  Json json = {{"schema", "vpr.reports/1"}, {"reports", Json::array()}};
  for (size_t i = 0; i < reports.size(); ++i)
    json["reports"].push_back({{"name", names[i]}, {"report", reports[i]}});
  add_run(json, run, seconds);
  return json;
}

Json protocols_json(const std::vector<ProtocolReport>& reports, const RunInfo& run,
                    double seconds) {
  Json json = {{"schema", "vpr.protocols/1"}, {"protocols", Json::array()}};
  for (const auto& [preset, report] : reports)
    json["protocols"].push_back(
        {{"name", preset->name}, {"source", preset->source}, {"report", report}});
  add_run(json, run, seconds);
  return json;
}

Table protocols_table(const std::vector<ProtocolReport>& reports) {
  std::vector<Table> rows;
  std::vector<std::string> names;
  for (const auto& [preset, report] : reports) {
    rows.push_back(report_table(report));
    names.emplace_back(preset->name);
  }
  Table table = stack_tables(rows, "protocol", names);
  table.title = evaluation_title(reports.front().report);
  return table;
}

std::string protocols_notes(const std::vector<ProtocolReport>& reports) {
  std::string notes;
  for (const ProtocolReport& one : reports)
    notes += one.report["protocol"]["ground_truth"].get<std::string>() + "\n";
  return notes;
}

}  // namespace vpr
