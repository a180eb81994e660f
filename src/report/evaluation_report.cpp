#include "report/evaluation_report.h"

#include <fmt/format.h>

namespace vpr {
namespace {

Json label_counts_json(const LabelCounts& counts) {
  return {
      {"correct", counts.correct}, {"incorrect", counts.incorrect}, {"ignored", counts.ignored}};
}

Json best_match_json(const BestMatchCounts& counts) {
  return {
      {"queries", counts.queries},       {"correct", counts.correct},
      {"ignored", counts.ignored},       {"without_match", counts.without_match},
      {"unreadable", counts.unreadable}, {"rate", counts.rate() ? Json(*counts.rate()) : Json()}};
}

Json protocol_json(const GroundTruth& truth) {
  return {{"ground_truth", truth.protocol},
          {"tolerance_frames", truth.tolerance_frames},
          {"anchor", "a window is judged at its last frame"},
          {"hits", "window pairs with a distance below the threshold"},
          {"places", "clusters of hits, judged at their mean"},
          {"distinct", "correct places"},
          {"best_match",
           "the window with the lowest distance, ties to the first; rate = correct / "
           "(queries - ignored)"},
          {"without_match",
           "a query window whose anchor has no match in the ground truth is not "
           "among the queries"}};
}

std::string text(const Json& json) {
  return json.is_string() ? json.get<std::string>() : json.dump();
}

}  // namespace

Json report_json(const SequenceResult& result, const SequenceCounts& counts,
                 const GroundTruth& truth, const std::string& result_fingerprint,
                 const RunInfo& run) {
  Json json = {{"schema", "vpr.report/1"}, {"method", result.settings.method}};
  json["query"] = result.query_name;
  json["settings"] = value_to_json(result.settings);
  json["counts"] = {{"hits", label_counts_json(counts.hits)},
                    {"places", label_counts_json(counts.places)},
                    {"distinct", counts.distinct}};
  json["best_match"] = best_match_json(counts.best_match);
  json["protocol"] = protocol_json(truth);
  json["provenance"] = provenance_json(run);
  json["provenance"]["result"] = result_fingerprint;
  return json;
}

Table report_table(const Json& report) {
  const Json& settings = report["settings"];
  const Json& hits = report["counts"]["hits"];
  const Json& places = report["counts"]["places"];
  const Json& best = report["best_match"];
  const bool automatic = settings["t_r"].is_string();
  Table table;
  table.title = fmt::format("{} on {} ({})", text(report["method"]), text(report["query"]),
                            text(report["protocol"]["ground_truth"]));
  table.columns = {
      "c_l", "t_r", "hits correct", "incorrect", "places correct", "incorrect", "best match right",
      "of",  "rate"};
  table.rows = {
      {text(settings["c_l"]),
       automatic ? "auto"
                 : fmt::format("{} {}", text(settings["t_r"]), text(settings["t_r_scale"])),
       text(hits["correct"]), text(hits["incorrect"]), text(places["correct"]),
       text(places["incorrect"]), text(best["correct"]), text(best["queries"]),
       best["rate"].is_null() ? "-" : fmt::format("{:.1f} %", 100 * best["rate"].get<double>())}};
  return table;
}

}  // namespace vpr
