#include "report/html_report.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "base/json.h"
#include "matching/score_kernels.h"
#include "report/evaluation_report.h"
#include "report/gallery_cards.h"
#include "report/html_text.h"
#include "report/metrics_report.h"
#include "report/palette.h"
#include "report/score_picture.h"
#include "report/scores_report.h"
#include "report/summary.h"
#include "report/svg_charts.h"
#include "report/timeline.h"

namespace vpr {
namespace {

#include "html_parts.inc"

constexpr size_t kMatrixSide = 800;  // pixels
constexpr std::string_view kMistakes =
    "<label><input type=\"radio\" name=\"kind\" value=\"mistake\"> worst mistakes</label>";

/// What is wider than the page scrolls, by keyboard, too.
std::string scroll_begin(const std::string& escaped_title) {
  return "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"" + escaped_title +
         "\">";
}

std::string table_html(const Table& table) {
  const std::string title = html_escaped(table.title);
  std::string html = "<p class=\"note\">" + title + "</p>" + scroll_begin(title) +
                     "<table aria-label=\"" + title + "\"><thead><tr>";
  for (const std::string& column : table.columns)
    html += "<th scope=\"col\">" + html_escaped(column) + "</th>";
  html += "</tr></thead><tbody>";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (const std::string& cell : row) html += "<td>" + html_escaped(cell) + "</td>";
    html += "</tr>";
  }
  return html + "</tbody></table></div>\n";
}

std::string list_html(const Json& object) {
  std::string html;
  for (const auto& item : object.items()) {
    std::string key = item.key();
    for (char& c : key)
      if (c == '_') c = ' ';
    const std::string value =
        item.value().is_string()
            ? item.value().get<std::string>()
            : item.value().dump(-1, ' ', false, Json::error_handler_t::replace);
    html += "<dt>" + html_escaped(key) + "</dt><dd>" + html_escaped(value) + "</dd>\n";
  }
  return html;
}

std::string matrix_html(const Json& report, const Judgement& judgement,
                        const ScorePicture& picture) {
  std::vector<uint8_t> png;
  cv::imencode(".png", picture.image, png);
  return matrix_svg(judgement, picture, base64(std::as_bytes(std::span(png))),
                    reference_word(report), score_words(report));
}

std::string legend_html(const std::vector<Meaning>& meanings) {
  std::string html;
  for (const Meaning meaning : meanings) html += legend_key(meaning);
  return html;
}

std::vector<Meaning> timeline_meanings(const Judgement& judgement, const GroundTruth& truth) {
  std::set<Meaning> found;
  for (const QueryOutcome& query : judgement.outcomes.queries)
    if (query.best) found.insert(meaning_of(judgement, query));
  for (const Fix fix : judgement.fixes)
    if (fix != Fix::none) found.insert(meaning_of(fix));
  if (truth.is_known) found.insert(Meaning::truth);
  return {found.begin(), found.end()};
}

/// Scores as thresholds are given: t_r in bits a frame or as mean z, t_p, or as they are.
ScoreAxis score_axis(const Json& report, const Judgement& judgement) {
  const auto length = static_cast<double>(judgement.layout.window_length);
  if (!report.contains("counts")) return {score_words(report), 1};
  if (report["settings"].contains("t_p")) return {"the probability t_p", 1};
  if (report["settings"].contains("score")) return {"the mean z (t_r)", length * kScoreUnit};
  return {"so many bits a frame (t_r with --t-r-scale bits)", length};
}

/// Both charts of best matches, with their legends.
std::string curves_html(const Json& report, const Judgement& judgement) {
  const auto figure = [](const std::string& svg, const std::string& title,
                         const std::vector<Meaning>& meanings) {
    return "<figure><figcaption>" + title + "</figcaption>" + svg + "<p class=\"legend\">" +
           legend_html(meanings) + "</p></figure>";
  };
  std::string html = "<div class=\"charts\">";
  std::set<Meaning> kinds;
  for (const QueryOutcome& query : judgement.outcomes.queries)
    if (query.best)
      kinds.insert(query.verdict == Verdict::correct     ? Meaning::right
                   : query.verdict == Verdict::incorrect ? Meaning::wrong
                                                         : Meaning::unjudged);
  if (!judgement.single_best.points.empty()) {
    std::vector<Meaning> curves = {Meaning::best_matches};
    if (judgement.all_pairs) curves.push_back(Meaning::all_pairs);
    html += figure(curve_svg(judgement), "Precision and recall", curves);
  }
  return html +
         figure(threshold_svg(judgement, score_axis(report, judgement)),
                "What a threshold recognises", {kinds.begin(), kinds.end()}) +
         "</div>";
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
               const TimelineFrame& frame) {
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
  data["left"] = frame.left;
  data["width"] = frame.plot_width;
  data["svg_width"] = frame.width;
  return data;
}

}  // namespace

std::string html_report(const Json& report, const std::string& summary, const Judgement& judgement,
                        const GroundTruth& truth, const ScoreMatrix* matrix,
                        const FrameSources& sources, const Monitor& monitor) {
  GalleryCards gallery(judgement, truth, sources);
  gallery.read_frames(monitor);
  const TimelineFrame frame;
  const ScorePicture picture = draw_scores(judgement, truth, matrix, kMatrixSide, monitor);
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
      kPage,
      {{"title", html_escaped(evaluation_title(report))},
       {"summary", html_escaped(summary)},
       {"subtitle", html_escaped("Ground truth: " + ground_truth)},
       {"style", palette_css() + std::string(kStyle)},
       {"script", std::string(kScript)},
       {"tables", tables_html(report, truth.is_known)},
       {"protocol", list_html(protocol)},
       {"provenance", list_html(made)},
       {"curves", curves_html(report, judgement)},
       {"timeline_legend", legend_html(timeline_meanings(judgement, truth))},
       {"timeline", timeline_svg(judgement, truth, reference_word(report), frame, monitor)},
       {"matrix_title", matrix != nullptr ? "Scores of all pairs" : "Recognitions of all pairs"},
       {"matrix_legend", legend_html(picture.shown)},
       {"matrix", matrix_html(report, judgement, picture)},
       {"gallery_title", truth.is_known ? "Mistakes and hits" : "Best matches"},
       {"mistakes", truth.is_known ? std::string(kMistakes) : ""},
       {"weak", truth.is_known ? "weakest right ones" : "weakest matches"},
       {"gallery_note", html_escaped(gallery.note())},
       {"cards", gallery.html()},
       {"data", script_json(page_data(report, judgement, truth.is_known, frame))}});
}

}  // namespace vpr
