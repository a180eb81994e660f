#include "report/html_data.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/json.h"
#include "report/chart_layout.h"
#include "report/evaluation_charts.h"
#include "report/evaluation_report.h"
#include "report/frame_axis.h"
#include "report/json_fields.h"
#include "report/metrics_report.h"

namespace vpr {
namespace {

constexpr size_t kMostPoints = 300;

Json scale_json(const AxisScale& scale) { return {scale.from, scale.to, scale.begin, scale.end}; }

Json area_json(const Chart& chart) {
  const ChartLayout layout = layout_of(chart, true);
  return {{"width", layout.width}, {"x", scale_json(layout.x)}, {"y", scale_json(layout.y)}};
}

Json bands_json(const std::vector<FrameBand>& bands) {
  Json json = Json::array();
  for (const FrameBand& band : bands)
    json.push_back({{"sequence", band.sequence},
                    {"at", band.at},
                    {"first", band.first_frame},
                    {"count", band.count}});
  return json;
}

void add_queries(Json& data, const Judgement& judgement) {
  data["matches"] = Json::array();
  data["scores"] = Json::array();
  Json ranks = Json::array();
  for (const QueryOutcome& query : judgement.outcomes.queries) {
    data["matches"].push_back(
        query.best ? Json::array({query.best->sequence, query.best->reference}) : Json());
    data["scores"].push_back(
        query.best ? Json(fmt::format("{:.6g}", score_of_key(query.key, judgement.outcomes.kind)))
                   : Json());
    ranks.push_back(query.rank.value_or(0));
  }
  if (judgement.outcomes.has_ranks) data["ranks"] = ranks;
  std::string recognised(judgement.fixes.size(), '.');
  for (const QueryOutcome& query : judgement.outcomes.queries)
    if (is_recognised(judgement, query)) recognised[query.frame] = 'f';
  data["recognised"] = recognised;
}

Json curve_points(const Curve& curve) {
  Json points = Json::array();
  for (const CurvePoint& point : thinned(curve, kMostPoints))
    points.push_back({curve.recall(point), Curve::precision(point)});
  return points;
}

// The margin that decided; null where none did, or each sequence has its own.
Json asked_margin(const Outcomes& outcomes) {
  std::optional<double> asked;
  if (outcomes.confidence == Confidence::score) return {};
  for (const QueryOutcome& query : outcomes.queries) {
    if (!query.asked_margin) continue;
    if (asked && *asked != *query.asked_margin) return {};
    asked = query.asked_margin;
  }
  return or_null(asked);
}

Json steps_json(const Json& report, const Judgement& judgement) {
  Json steps = Json::array();
  for (const ThresholdStep& step : threshold_steps(report, judgement, kMostPoints))
    steps.push_back({step.threshold, step.accepted[0], step.accepted[1], step.accepted[2]});
  return steps;
}

// Where frames are those of recordings that are replayed or thinned: which.
void add_sources(Json& data, const GroundTruthScope& scope) {
  if (scope.replay) data["query_sources"] = scope.replay->sources;
  if (std::ranges::none_of(scope.sequences, [](const auto& s) { return s.kept.has_value(); }))
    return;
  for (const auto& sequence : scope.sequences)
    data["train_sources"].push_back(sequence.kept ? Json(sequence.kept->sources) : Json());
}

}  // namespace

Json page_data(const Json& report, const Judgement& judgement, bool is_judged,
               const PageCharts& charts) {
  Json data;
  data["best"] = report["outcomes"]["best"];
  data["first_frame"] = report["outcomes"]["first_frame"];
  data["kind"] = score_words(report);
  data["judged"] = is_judged;
  data["sequences"] = Json::array();
  for (const auto& sequence : judgement.layout.scope.sequences)
    data["sequences"].push_back(sequence.name);
  add_queries(data, judgement);
  add_sources(data, judgement.layout.scope);
  data["areas"] = {{"timeline", area_json(charts.timeline)},
                   {"matrix", area_json(charts.matrix)},
                   {"thresholds", area_json(charts.thresholds)},
                   {"precision-recall", area_json(charts.curve)}};
  data["frames"] = bands_json(frame_bands(judgement.layout));
  data["columns"] = bands_json(column_bands(judgement.layout));
  data["rows"] = bands_json(row_bands(judgement.layout));
  data["to_find"] = judgement.single_best.to_find;
  data["curve"] = curve_points(judgement.single_best);
  data["steps"] = steps_json(report, judgement);
  data["order"] = enum_name(confidence_order(judgement.outcomes));
  data["asked"] = asked_margin(judgement.outcomes);
  return data;
}

}  // namespace vpr
