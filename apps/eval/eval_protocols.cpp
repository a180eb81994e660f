#include "eval_protocols.h"

#include <fmt/format.h>

#include "base/json.h"
#include "base/stopwatch.h"
#include "ground_truth/presets.h"
#include "report/evaluation_report.h"

namespace vpr {

void evaluate_protocols(Session& session, const std::string& protocols, const std::string& result,
                        TableFormat format,
                        const std::function<Json(const std::string& ground_truth)>& evaluate) {
  session.claim_output();
  const Stopwatch watch;
  Json json = {{"schema", "vpr.protocols/1"}, {"protocols", Json::array()}};
  Table table;
  std::string notes;
  for (const GroundTruthPreset* preset : find_presets(protocols)) {
    const std::string name(preset->name);
    const Json report = evaluate(name);
    Table one = report_table(report);
    one.columns.insert(one.columns.begin(), "protocol");
    table.columns = one.columns;
    for (auto& row : one.rows) {
      row.insert(row.begin(), name);
      table.rows.push_back(std::move(row));
    }
    notes += fmt::format("{}\n", report["protocol"]["ground_truth"].get<std::string>());
    table.title = fmt::format("{} on {}", method_title(report), report["query"].get<std::string>());
    json["protocols"].push_back({{"name", name}, {"source", preset->source}, {"report", report}});
  }
  RunInfo info = session.run;
  info.paths = {{"result", result}};
  json["machine"] = machine_json(info);
  json["timing"] = timing_json({{"evaluate", watch.elapsed_s()}});
  session.write_output(json);
  session.print_result(render_table(table, format) + (format == TableFormat::text ? notes : ""),
                       json);
}

}  // namespace vpr
