#include "report/html_report.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "base/json.h"
#include "evaluation/metrics.h"
#include "report/chart_layout.h"
#include "report/chart_svg.h"
#include "report/evaluation_charts.h"
#include "report/evaluation_report.h"
#include "report/gallery_cards.h"
#include "report/html_data.h"
#include "report/html_parts.h"
#include "report/html_text.h"
#include "report/metrics_report.h"
#include "report/palette.h"
#include "report/score_picture.h"
#include "report/scores_report.h"
#include "report/summary.h"

namespace vpr {
namespace {

constexpr size_t kMatrixSide = 800;  // pixels
constexpr std::string_view kMistakes =
    "<label><input type=\"radio\" name=\"kind\" value=\"mistake\"> worst mistakes</label>";

constexpr std::string_view kDisagreements =
    "<button type=\"button\" id=\"next-disagreement\">next disagreement (n)</button>\n"
    "<button type=\"button\" id=\"save-disagreements\">save disagreements.csv</button>";

bool by_margin(const Judgement& judgement) {
  return judgement.outcomes.confidence == Confidence::margin;
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
std::string risk_areas(const Judgement& judgement) {
  const auto area = [](const Curve& curve) {
    const auto value = risk_coverage_area(curve).value;
    return value ? fmt::format("{:.3f}", *value) : std::string("not defined");
  };
  const std::string single = area(judgement.single_best);
  if (!judgement.other_best) return single;
  const std::string other = area(*judgement.other_best);
  return fmt::format("{} by score, {} by margin", by_margin(judgement) ? other : single,
                     by_margin(judgement) ? single : other);
}

PageCharts page_charts(const Json& report, const Judgement& judgement, const GroundTruth& truth,
                       const ScoreMatrix* matrix, const Monitor& monitor) {
  PageCharts charts = {
      curve_chart(report, judgement), risk_chart(report, judgement),
      threshold_chart(report, judgement), timeline_chart(report, judgement, truth, monitor),
      matrix_chart(judgement.layout, draw_scores(judgement, truth, matrix, kMatrixSide, monitor),
                   reference_word(report), score_words(report))};
  charts.curve.title = "Precision and recall";
  charts.risk.title = "Risk and coverage: area " + risk_areas(judgement);
  charts.thresholds.title =
      by_margin(judgement) ? "What a margin recognizes" : "What a threshold recognizes";
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
std::string margins_html(const Json& report, const Judgement& judgement) {
  Chart chart = margin_chart(report, judgement);
  if (chart.series.empty()) return "";
  chart.title = "margin of every query frame's best match";
  chart.height = 300;
  return "<h3>Margins: how much better than elsewhere</h3>\n<p class=\"legend\">" +
         legend_html(meanings_of(chart)) + "</p>" + scroll_begin(html_escaped(chart.title)) +
         page_svg(chart) + "</div>\n";
}

/// What the first table says, without the protocol, which stands above.
std::string tables_html(const Json& report, bool is_judged) {
  if (!is_judged) return table_html(unjudged_table(report));
  Table summary = summary_table(report);
  summary.title = "Counts";
  std::string html = table_html(summary);
  for (const Table& table : metrics_tables(report)) html += table_html(table);
  return html;
}

}  // namespace

std::string html_report(const Json& report, const std::string& summary, const Judgement& judgement,
                        const GroundTruth& truth, const ScoreMatrix* matrix,
                        const FrameSources& sources, const Monitor& monitor) {
  GalleryCards gallery(judgement, truth, sources);
  gallery.read_frames(monitor);
  const PageCharts charts = page_charts(report, judgement, truth, matrix, monitor);
  Json made = report["settings"];
  made.update(report["provenance"]);
  if (report.contains("machine")) made["command_line"] = report["machine"]["command_line"];
  Json protocol = report["protocol"];
  protocol.erase("ground_truth");  // stands on top
  if (truth.is_known)
    protocol.erase("localisation");  // and above its table
  else
    for (const char* key :
         {"tolerance_frames", "distinct", "best_match", "without_match", "single_best"})
      protocol.erase(key);  // what is judged
  const std::string ground_truth = report["protocol"]["ground_truth"].get<std::string>();
  return fill_page(
      html_parts().page,
      {{"title", html_escaped(evaluation_title(report))},
       {"summary", html_escaped(summary)},
       {"subtitle", html_escaped("Ground truth: " + ground_truth)},
       {"style", palette_css() + std::string(html_parts().style)},
       {"script", std::string(html_parts().script) + std::string(html_parts().hover_script) +
                      std::string(html_parts().label_script)},
       {"disagreements", truth.is_known ? std::string(kDisagreements) : ""},
       {"tables", tables_html(report, truth.is_known)},
       {"protocol", list_html(protocol)},
       {"provenance", list_html(made)},
       {"curves", curves_html(charts)},
       {"threshold", by_margin(judgement) ? "Margin" : "Threshold"},
       {"timeline_legend", legend_html(meanings_of(charts.timeline))},
       {"timeline", page_svg(charts.timeline)},
       {"margins", margins_html(report, judgement)},
       {"matrix_title", matrix != nullptr ? "Scores of all pairs" : "Recognitions of all pairs"},
       {"matrix_legend", legend_html(meanings_of(charts.matrix))},
       {"matrix", page_svg(charts.matrix)},
       {"gallery_title", truth.is_known ? "Mistakes and hits" : "Best matches"},
       {"mistakes", truth.is_known ? std::string(kMistakes) : ""},
       {"weak", truth.is_known ? "weakest right ones" : "weakest matches"},
       {"gallery_note", html_escaped(gallery.note())},
       {"cards", gallery.html()},
       {"data", script_json(page_data(report, judgement, truth.is_known, charts))}});
}

}  // namespace vpr
