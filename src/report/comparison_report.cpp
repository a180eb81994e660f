#include "report/comparison_report.h"

#include <algorithm>

#include "base/json.h"
#include "report/json_fields.h"
#include "report/scores_report.h"

namespace vpr {

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
                                 {"wrong", or_null(reports[m].wrong)},
                                 {"longest_gap_frames", or_null(reports[m].longest_gap)}}},
                               {"oracle", reports[m].is_oracle},
                               {"confidence", enum_name(reports[m].outcomes.confidence)},
                               {"fingerprint", reports[m].fingerprint}});
    if (!reports[m].walk.empty()) json["reports"].back()["walk"] = reports[m].walk;
    if (reports[m].ground_truth_fingerprint)
      json["reports"].back()["ground_truth_fingerprint"] = *reports[m].ground_truth_fingerprint;
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

}  // namespace vpr
