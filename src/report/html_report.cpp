#include "report/html_report.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "base/json.h"
#include "report/chart_layout.h"
#include "report/chart_svg.h"
#include "report/evaluation_charts.h"
#include "report/evaluation_report.h"
#include "report/gallery_cards.h"
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

/// Two charts side by side, with their legends.
std::string curves_html(const Json& report, const Judgement& judgement) {
  const auto figure = [](Chart chart, const std::string& title) {
    chart.title = title;
    chart.width = 650;
    chart.height = 450;
    return "<figure><figcaption>" + title + "</figcaption>" + page_svg(chart) +
           "<p class=\"legend\">" + legend_html(meanings_of(chart)) + "</p></figure>";
  };
  std::string html = "<div class=\"charts\">";
  const Chart curves = curve_chart(report, judgement);
  if (!curves.series.empty()) html += figure(curves, "Precision and recall");
  return html + figure(threshold_chart(report, judgement), "What a threshold recognises") +
         "</div>";
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

/// What scripts look up: a line of data for each query.
Json page_data(const Json& report, const Judgement& judgement, bool is_judged,
               const ChartLayout& timeline) {
  Json data;
  data["best"] = report["outcomes"]["best"];
  data["first_frame"] = report["outcomes"]["first_frame"];
  data["kind"] = score_words(report);
  data["sequences"] = Json::array();
  for (const auto& sequence : judgement.layout.scope.sequences)
    data["sequences"].push_back(sequence.name);
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
  data["judged"] = is_judged;
  std::string recognised(judgement.fixes.size(), '.');
  for (const QueryOutcome& query : judgement.outcomes.queries)
    if (is_recognised(judgement, query)) recognised[query.frame] = 'f';
  data["recognised"] = recognised;
  data["frames"] = std::max<size_t>(1, judgement.fixes.size());
  data["left"] = timeline.area.left;
  data["width"] = timeline.area.width;
  data["svg_width"] = timeline.width;
  return data;
}

}  // namespace

std::string html_report(const Json& report, const std::string& summary, const Judgement& judgement,
                        const GroundTruth& truth, const ScoreMatrix* matrix,
                        const FrameSources& sources, const Monitor& monitor) {
  GalleryCards gallery(judgement, truth, sources);
  gallery.read_frames(monitor);
  Chart timeline = timeline_chart(report, judgement, truth, monitor);
  timeline.title = "best match of every query frame";
  timeline.height = 440;
  const ScorePicture picture = draw_scores(judgement, truth, matrix, kMatrixSide, monitor);
  Chart pairs =
      matrix_chart(judgement.layout, picture, reference_word(report), score_words(report));
  pairs.title = "queries against references";
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
       {"script", std::string(html_parts().script)},
       {"tables", tables_html(report, truth.is_known)},
       {"protocol", list_html(protocol)},
       {"provenance", list_html(made)},
       {"curves", curves_html(report, judgement)},
       {"timeline_legend", legend_html(meanings_of(timeline))},
       {"timeline", page_svg(timeline)},
       {"margins", margins_html(report, judgement)},
       {"matrix_title", matrix != nullptr ? "Scores of all pairs" : "Recognitions of all pairs"},
       {"matrix_legend", legend_html(meanings_of(pairs))},
       {"matrix", page_svg(pairs)},
       {"gallery_title", truth.is_known ? "Mistakes and hits" : "Best matches"},
       {"mistakes", truth.is_known ? std::string(kMistakes) : ""},
       {"weak", truth.is_known ? "weakest right ones" : "weakest matches"},
       {"gallery_note", html_escaped(gallery.note())},
       {"cards", gallery.html()},
       {"data",
        script_json(page_data(report, judgement, truth.is_known, layout_of(timeline, true)))}});
}

}  // namespace vpr
