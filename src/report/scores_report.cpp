#include "report/scores_report.h"

#include <fmt/format.h>

#include "base/json.h"
#include "ground_truth/check.h"
#include "report/evaluation_report.h"
#include "report/json_fields.h"
#include "report/metrics_report.h"

namespace vpr {
namespace {

Json settings_json(const ScoreSettings& settings) {
  return {{"method", settings.method},
          {"scores", settings.format.is_similarity ? "similarity" : "distance"},
          {"references_first", settings.format.references_first},
          {"missing", or_null(settings.format.missing)},
          {"window", settings.window_length},
          {"threshold", or_null(settings.threshold)}};
}

// One row: the matrix and its best matches.
Table scores_table(const Json& report) {
  const Json& best = report["best_match"];
  Table table;
  table.title = fmt::format("{} on {} ({})", report["method"].get<std::string>(),
                            report["query"].get<std::string>(),
                            report["protocol"]["ground_truth"].get<std::string>());
  table.columns = {"scores", "window", "best right", "of", "per cent"};
  table.rows = {
      {report["settings"]["scores"].get<std::string>(), report["settings"]["window"].dump(),
       best["correct"].dump(),
       std::to_string(best["queries"].get<uint64_t>() - best["ignored"].get<uint64_t>()),
       best["rate"].is_null() ? "-" : fmt::format("{:.1f}", 100 * best["rate"].get<double>())}};
  return table;
}

}  // namespace

Json scores_report_json(const ScoreSettings& settings, const std::string& query,
                        const Judgement& judgement, const GroundTruth& truth,
                        const std::string& fingerprint, const RunInfo& run) {
  Json json = {{"schema", "vpr.report/1"}, {"method", settings.method}};
  json["query"] = query;
  if (settings.replay) add_replay(json, *settings.replay);
  json["settings"] = settings_json(settings);
  json["best_match"] = best_match_json(best_match_counts(judgement.outcomes));
  add_judgement(json, judgement);
  json["protocol"] = protocol_json(truth);
  if (settings.window_length > 1)
    json["protocol"]["anchor"] = "a window is judged at its last frame";
  json["protocol"]["best_match"] =
      "the reference with the best score, ties to the first; rate = correct / (queries - ignored)";
  json["protocol"]["without_match"] =
      "a query without a match in the ground truth is not among the queries of rate and recall";
  if (settings.window_length > 1)
    json["protocol"]["unreachable"] =
        "neither is one whose anchor has matches only where no training window ends";
  json["protocol"]["unreadable"] = "a query without any score";
  add_metrics_protocol(json["protocol"], judgement, false);
  json["provenance"] = provenance_json(run);
  json["provenance"]["scores"] = fingerprint;
  json["provenance"]["ground_truth"] = ground_truth_fingerprint(truth, judgement.layout.scope);
  return json;
}

Table summary_table(const Json& report) {
  return report.contains("counts") ? report_table(report) : scores_table(report);
}

}  // namespace vpr
