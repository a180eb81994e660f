#include "report/html_report.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "base/json.h"
#include "report/evaluation_report.h"
#include "report/gallery.h"
#include "report/html_text.h"
#include "report/metrics_report.h"
#include "report/score_picture.h"
#include "report/scores_report.h"
#include "report/svg_charts.h"
#include "report/thumbnails.h"

namespace vpr {
namespace {

#include "html_parts.inc"

constexpr size_t kMostItems = 18;  // of each kind in the gallery
constexpr size_t kStripFrames = 5;
constexpr int kThumbnailSide = 128;  // pixels
constexpr size_t kMatrixSide = 800;  // pixels

std::string table_html(const Table& table) {
  const std::string title = html_escaped(table.title);
  std::string html = "<p class=\"note\">" + title +
                     "</p><div class=\"scroll\"><table aria-label=\"" + title + "\"><thead><tr>";
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

std::string matrix_html(const Judgement& judgement, const GroundTruth& truth,
                        const ScoreMatrix* matrix, const Monitor& monitor) {
  const cv::Mat image = draw_scores(judgement, truth, matrix, kMatrixSide, monitor);
  std::vector<uint8_t> png;
  cv::imencode(".png", image, png);
  return fmt::format(
      "<img class=\"matrix\" width=\"{}\" height=\"{}\" alt=\"queries against references\" "
      "src=\"data:image/png;base64,{}\">",
      std::max(400, image.cols), std::max(400, image.cols) * image.rows / image.cols,
      base64(std::as_bytes(std::span(png))));
}

/// What a number beside a match is: sums of standardized scores are in 1/1024 deviations.
std::string score_word(const Json& report) {
  if (report.contains("settings") && report["settings"].contains("score"))
    return "standardized score (1/1024, summed)";
  return report["outcomes"]["scores_are"].get<std::string>();
}

/// What scripts look up: a line of data for each query.
Json page_data(const Json& report, const Judgement& judgement, const TimelineFrame& frame) {
  Json data;
  data["best"] = report["outcomes"]["best"];
  data["first_frame"] = report["outcomes"]["first_frame"];
  data["kind"] = score_word(report);
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

/// The cards of the gallery, with the pictures that they need.
class Gallery {
 public:
  Gallery(const Judgement& judgement, const GroundTruth& truth, const FrameSources& sources)
      : judgement_(judgement), sources_(sources) {
    items_ = choose_gallery(judgement, truth, kMostItems);
  }

  void read_frames(const Monitor& monitor) {
    std::set<size_t> query;
    std::vector<std::set<size_t>> references(sources_.references.size());
    const auto want = [&](const FrameMatch& match) {
      if (match.sequence < references.size())
        for (const size_t frame : frames_at(match.reference))
          references[match.sequence].insert(frame);
    };
    for (const GalleryItem& item : items_) {
      const QueryOutcome& outcome = outcome_of(item);
      for (const size_t frame : frames_at(outcome.frame)) query.insert(frame);
      want(*outcome.best);
      if (item.truth) want(*item.truth);
    }
    if (sources_.query) query_ = make_thumbnails(*sources_.query, query, kThumbnailSide, monitor);
    references_.resize(references.size());
    for (size_t s = 0; s < references.size(); ++s)
      if (sources_.references[s])
        references_[s] =
            make_thumbnails(*sources_.references[s], references[s], kThumbnailSide, monitor);
  }

  std::string html() const {
    std::string html;
    for (const GalleryItem& item : items_) html += card(item);
    return html;
  }

  std::string note() const {
    if (items_.empty()) return "No query has a best match that can be judged.";
    std::string text = fmt::format(
        "At most {} of each kind, of queries at least a window apart. Arrow keys go from one to "
        "the "
        "next, / to the search.",
        kMostItems);
    if (!sources_.query)
      text += " Give the sequences (--query, --train or --dataset) for pictures.";
    return text;
  }

 private:
  const QueryOutcome& outcome_of(const GalleryItem& item) const {
    return judgement_.outcomes.queries[item.query];
  }
  std::vector<size_t> frames_at(size_t anchor) const {
    return strip_frames(anchor, judgement_.layout.window_length, kStripFrames);
  }

  std::string place(const FrameMatch& match) const {
    return fmt::format("{} {}", judgement_.layout.scope.sequences[match.sequence].name,
                       match.reference);
  }

  static std::string strip(const std::string& title, const std::vector<size_t>& frames,
                           const std::map<size_t, Thumbnail>& thumbnails) {
    const auto last = thumbnails.find(frames.back());
    const std::string name = last == thumbnails.end() ? "" : ": " + last->second.name;
    std::string html = "<figure><figcaption>" + html_escaped(title + name) + "</figcaption>";
    if (thumbnails.empty()) return html + "</figure>";
    html += "<div class=\"strip\">";
    for (const size_t frame : frames) {
      const auto found = thumbnails.find(frame);
      if (found == thumbnails.end() || found->second.jpeg.empty())
        html += "<span class=\"gone\">no picture</span>";
      else
        html += fmt::format("<img alt=\"frame {}\" title=\"{}\" src=\"data:image/jpeg;base64,{}\">",
                            frame, html_escaped(found->second.name), base64(found->second.jpeg));
    }
    return html + "</div></figure>";
  }

  std::string reference_strip(const std::string& title, const FrameMatch& match) const {
    static const std::map<size_t, Thumbnail> kNone;
    const auto& thumbnails =
        match.sequence < references_.size() ? references_[match.sequence] : kNone;
    return strip(title + " " + place(match), frames_at(match.reference), thumbnails);
  }

  std::string card(const GalleryItem& item) const {
    const QueryOutcome& outcome = outcome_of(item);
    const std::string_view kind = enum_name(item.kind);
    std::string html = fmt::format(
        "<article class=\"card {0}\" data-kind=\"{0}\" tabindex=\"0\"><h3>{1}: query {2}</h3>",
        kind, outcome.verdict == Verdict::correct ? "right" : "wrong", outcome.frame);
    html += fmt::format("<p>{} {:.6g}{}{}</p>", enum_name(judgement_.outcomes.kind),
                        score_of_key(outcome.key, judgement_.outcomes.kind),
                        is_recognised(judgement_, outcome) ? ", recognised" : ", not recognised",
                        item.truth ? "" : "; the ground truth has no match");
    html += strip(fmt::format("query {}", outcome.frame), frames_at(outcome.frame), query_);
    html += reference_strip("best match", *outcome.best);
    if (item.truth) html += reference_strip("true place", *item.truth);
    return html + "</article>\n";
  }

  const Judgement& judgement_;
  const FrameSources& sources_;
  std::vector<GalleryItem> items_;
  std::map<size_t, Thumbnail> query_;
  std::vector<std::map<size_t, Thumbnail>> references_;
};

}  // namespace

std::string html_report(const Json& report, const Judgement& judgement, const GroundTruth& truth,
                        const ScoreMatrix* matrix, const FrameSources& sources,
                        const Monitor& monitor) {
  Gallery gallery(judgement, truth, sources);
  gallery.read_frames(monitor);
  const TimelineFrame frame;
  std::string tables = table_html(summary_table(report));
  for (const Table& table : metrics_tables(report)) tables += table_html(table);
  Json made = report["settings"];
  made.update(report["provenance"]);
  if (report.contains("machine")) made["command_line"] = report["machine"]["command_line"];
  const std::string method = method_title(report);
  const std::string query = report["query"].get<std::string>();
  return fill_page(
      kPage,
      {{"title", html_escaped(fmt::format("{} on {}", method, query))},
       {"subtitle", html_escaped(report["protocol"]["ground_truth"].get<std::string>())},
       {"style", std::string(kStyle)},
       {"script", std::string(kScript)},
       {"tables", tables},
       {"protocol", list_html(report["protocol"])},
       {"provenance", list_html(made)},
       {"curve", curve_svg(judgement)},
       {"timeline", timeline_svg(judgement, truth, frame)},
       {"matrix_title", matrix != nullptr ? "Scores of all pairs" : "Recognitions of all pairs"},
       {"matrix_legend",
        fmt::format("Queries from top to bottom, references from left to right{}. Green: ground "
                    "truth; blue: recognised, right; red: recognised, wrong.",
                    matrix != nullptr ? "; dark is a good score" : "")},
       {"matrix", matrix_html(judgement, truth, matrix, monitor)},
       {"gallery_note", html_escaped(gallery.note())},
       {"cards", gallery.html()},
       {"data", script_json(page_data(report, judgement, frame))}});
}

}  // namespace vpr
