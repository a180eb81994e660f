#include "present/html_report.h"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "base/json.h"
#include "base/json_fields.h"
#include "evaluate/metrics.h"
#include "present/chart_layout.h"
#include "present/evaluation_charts.h"
#include "present/evaluation_tables.h"
#include "present/html_page.h"
#include "present/score_matrix.h"

namespace vpr {
namespace {

/// The charts of the page, as it draws them.
struct PageCharts {
  Chart curve;
  Chart risk;
  Chart thresholds;
  Chart timeline;
  Chart matrix;
};

constexpr size_t kMatrixSide = 800;  // pixels
constexpr std::string_view kMistakes =
    "<label><input type=\"radio\" name=\"kind\" value=\"mistake\"> worst mistakes</label>";

constexpr std::string_view kDisagreements =
    "<button type=\"button\" id=\"next-disagreement\">next disagreement (n)</button>\n"
    "<button type=\"button\" id=\"save-disagreements\">save disagreements.csv</button>";

bool by_margin(const Judgment& judgment) {
  return judgment.outcomes.confidence == Confidence::margin;
}

/// Charts side by side, with their legends.
std::string curves_html(const PageCharts& charts) {
  const auto figure = [](const Chart& chart, const std::string& title) {
    return "<figure><figcaption>" + title + "</figcaption>" + page_svg(chart) +
           "<p class=\"legend\">" + legend_html(meanings_of(chart)) + "</p></figure>";
  };
  std::string html = "<div class=\"charts\">";
  if (!charts.curve.series.empty()) html += figure(charts.curve, charts.curve.title);
  if (!charts.risk.series.empty()) html += figure(charts.risk, charts.risk.title);
  // The slider below belongs to the last.
  return html + figure(charts.thresholds, charts.thresholds.title) + "</div>";
}

/// "0.031", or "0.031 by score, 0.012 by margin" where there are both.
std::string risk_areas(const Judgment& judgment) {
  const auto area = [](const Curve& curve) {
    const auto value = risk_coverage_area(curve).value;
    return value ? fmt::format("{:.3f}", *value) : std::string("not defined");
  };
  const std::string single = area(judgment.single_best);
  if (!judgment.other_best) return single;
  const std::string other = area(*judgment.other_best);
  return fmt::format("{} by score, {} by margin", by_margin(judgment) ? other : single,
                     by_margin(judgment) ? single : other);
}

PageCharts page_charts(const Evaluation& evaluation, const Report& report, const Monitor& monitor) {
  const Judgment& judgment = evaluation.judgment;
  PageCharts charts = {curve_chart(report, judgment), risk_chart(report, judgment),
                       threshold_chart(report, judgment),
                       timeline_chart(report, judgment, evaluation.truth, monitor),
                       matrix_chart(evaluation, report, kMatrixSide, monitor)};
  charts.curve.title = "Precision and recall";
  charts.risk.title = "Risk and coverage: area " + risk_areas(judgment);
  charts.thresholds.title =
      by_margin(judgment) ? "What a margin recognizes" : "What a threshold recognizes";
  for (Chart* chart : {&charts.curve, &charts.risk, &charts.thresholds}) {
    chart->width = 650;
    chart->height = 450;
  }
  charts.timeline.title = "best match of every query frame";
  charts.timeline.height = 440;
  charts.matrix.title = "queries against references";
  return charts;
}

/// Margins along the path, with their legend; nothing where none are known.
std::string margins_html(const Report& report, const Judgment& judgment) {
  Chart chart = margin_chart(report, judgment);
  if (chart.series.empty()) return "";
  chart.title = "margin of every query frame's best match";
  chart.height = 300;
  return "<h3>Margins: how much better than elsewhere</h3>\n<p class=\"legend\">" +
         legend_html(meanings_of(chart)) + "</p>" + scroll_begin(html_escaped(chart.title)) +
         page_svg(chart) + "</div>\n";
}

/// What the first table says, without the protocol, which stands above.
std::string tables_html(const Report& report, bool is_judged) {
  if (!is_judged) return table_html(unjudged_table(report));
  Table summary = report_table(report);
  summary.title = "Counts";
  std::string html = table_html(summary);
  for (const Table& table : metrics_tables(report)) html += table_html(table);
  return html;
}

constexpr size_t kMostPoints = 300;  // of curves in the data

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

void add_queries(Json& data, const Judgment& judgment) {
  data["matches"] = Json::array();
  data["scores"] = Json::array();
  Json ranks = Json::array();
  for (const QueryOutcome& query : judgment.outcomes.queries) {
    data["matches"].push_back(
        query.best ? Json::array({query.best->sequence, query.best->reference}) : Json());
    data["scores"].push_back(
        query.best ? Json(fmt::format("{:.6g}", score_of_key(query.key, judgment.outcomes.kind)))
                   : Json());
    ranks.push_back(query.rank.value_or(0));
  }
  if (judgment.outcomes.has_ranks) data["ranks"] = ranks;
  std::string recognized(judgment.fixes.size(), '.');
  for (const QueryOutcome& query : judgment.outcomes.queries)
    if (is_recognized(judgment, query)) recognized[query.frame] = 'f';
  data["recognized"] = recognized;
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

Json steps_json(const Report& report, const Judgment& judgment) {
  Json steps = Json::array();
  for (const ThresholdStep& step : threshold_steps(report, judgment, kMostPoints))
    steps.push_back({step.threshold, step.accepted[0], step.accepted[1], step.accepted[2]});
  return steps;
}

// The recording's frame of each frame, where frames are selected.
void add_sources(Json& data, const GroundTruthScope& scope) {
  const auto is_all = [](const auto& train) { return train.sequence.selection.is_all(); };
  if (const Selection& selection = scope.query.selection; !selection.is_all())
    data["query_sources"] = selection.sources;
  if (std::ranges::all_of(scope.sequences, is_all)) return;
  for (const auto& train : scope.sequences)
    data["train_sources"].push_back(is_all(train) ? Json()
                                                  : Json(train.sequence.selection.sources));
}

// A line of data for each query, the scales of all charts (from, to, begin and end of both axes in
// units of the SVG), frames of the axes by bands, points of the curve, and counts by threshold.
Json page_data(const Report& report, const Judgment& judgment, bool is_judged,
               const PageCharts& charts) {
  Json data;
  data["best"] = outcome_letters(report.outcomes);
  data["first_frame"] = report.outcomes.window_length - 1;
  data["kind"] = score_words(report);
  data["judged"] = is_judged;
  data["sequences"] = Json::array();
  for (const auto& train : judgment.layout.scope.sequences)
    data["sequences"].push_back(train.sequence.name);
  add_queries(data, judgment);
  add_sources(data, judgment.layout.scope);
  data["areas"] = {{"timeline", area_json(charts.timeline)},
                   {"matrix", area_json(charts.matrix)},
                   {"thresholds", area_json(charts.thresholds)},
                   {"precision-recall", area_json(charts.curve)}};
  data["frames"] = bands_json(frame_bands(judgment.layout));
  data["columns"] = bands_json(column_bands(judgment.layout));
  data["rows"] = bands_json(row_bands(judgment.layout));
  data["to_find"] = judgment.single_best.to_find;
  data["curve"] = curve_points(judgment.single_best, kMostPoints);
  data["steps"] = steps_json(report, judgment);
  data["order"] = enum_name(confidence_order(judgment.outcomes));
  data["asked"] = asked_margin(judgment.outcomes);
  return data;
}

}  // namespace

std::string html_report(const Evaluation& evaluation, const Report& report, const RunInfo& run,
                        const std::string& summary, const FrameSources& sources,
                        const Monitor& monitor) {
  const Judgment& judgment = evaluation.judgment;
  const GroundTruth& truth = evaluation.truth;
  GalleryCards gallery(judgment, truth, sources);
  gallery.read_frames(monitor);
  const PageCharts charts = page_charts(evaluation, report, monitor);
  Json json = report_json(report);
  Json made = json["settings"];
  made.update(json["provenance"]);
  if (!run.command_line.empty()) made["command_line"] = run.command_line;
  Json& protocol = json["protocol"];
  protocol.erase("ground_truth");  // stands on top
  if (truth.is_known)
    protocol.erase("localization");  // and above its table
  else
    for (const char* key :
         {"tolerance_frames", "distinct", "best_match", "without_match", "single_best"})
      protocol.erase(key);  // what is judged
  return fill_page(
      html_parts().page,
      {{"title", html_escaped(evaluation_title(report))},
       {"summary", html_escaped(summary)},
       {"subtitle", html_escaped("Ground truth: " + truth.protocol)},
       {"style", palette_css() + std::string(html_parts().style)},
       {"script", std::string(html_parts().script) + std::string(html_parts().hover_script) +
                      std::string(html_parts().label_script)},
       {"disagreements", truth.is_known ? std::string(kDisagreements) : ""},
       {"tables", tables_html(report, truth.is_known)},
       {"protocol", list_html(protocol)},
       {"provenance", list_html(made)},
       {"curves", curves_html(charts)},
       {"threshold", by_margin(judgment) ? "Margin" : "Threshold"},
       {"timeline_legend", legend_html(meanings_of(charts.timeline))},
       {"timeline", page_svg(charts.timeline)},
       {"margins", margins_html(report, judgment)},
       {"matrix_title", evaluation.matrix ? "Scores of all pairs" : "Recognitions of all pairs"},
       {"matrix_legend", legend_html(meanings_of(charts.matrix))},
       {"matrix", page_svg(charts.matrix)},
       {"gallery_title", truth.is_known ? "Mistakes and recognitions" : "Best matches"},
       {"mistakes", truth.is_known ? std::string(kMistakes) : ""},
       {"weak", truth.is_known ? "weakest right ones" : "weakest matches"},
       {"gallery_note", html_escaped(gallery.note())},
       {"cards", gallery.html()},
       {"data", script_json(page_data(report, judgment, truth.is_known, charts))}});
}

}  // namespace vpr
