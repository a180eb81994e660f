#include "present/evaluation_page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/json.h"
#include "base/text.h"
#include "evaluate/report.h"
#include "html_parts.h"  // the files of src/present/html, by the build
#include "present/chart.h"
#include "present/evaluation_charts.h"
#include "present/html_page.h"
#include "present/matrix_chart.h"
#include "present/report_tables.h"
#include "present/result_text.h"
#include "query/witness.h"

namespace vpr {
namespace {

constexpr size_t kPageMatrixSide = 800;  // pixels
constexpr double kPageWidth = 1180;      // of charts along the path
constexpr size_t kMostPagePoints = 300;  // of curves in the data
constexpr size_t kMostPictured = 120;    // queries with images at the slider
constexpr std::string_view kDisagreements =
    "<button type=\"button\" id=\"next-disagreement\">next disagreement (n)</button>\n"
    "<button type=\"button\" id=\"save-disagreements\">save disagreements.csv</button>";

bool by_margin(const Judgment& judgment) {
  return judgment.outcomes.confidence == Confidence::margin;
}

Chart sized(Chart chart, const std::string& title, double width, double height) {
  chart.title = title;
  chart.width = width;
  chart.height = height;
  return chart;
}

Chart path_chart(const Evaluation& evaluation, const Report& report, const Monitor& monitor) {
  return sized(timeline_chart(report, evaluation.judgment, evaluation.truth, monitor),
               "Best match of every query frame", kPageWidth, 440);
}

// Precision and recall, accepted matches by threshold, and risk.
std::array<Chart, 3> curve_charts(const Report& report, const Judgment& judgment) {
  const char* title = by_margin(judgment) ? "Recognitions by margin" : "Recognitions by threshold";
  return {sized(curve_chart(report, judgment), "Precision and recall", 360, 320),
          sized(threshold_chart(report, judgment), title, 360, 320),
          sized(risk_chart(report, judgment), "Risk and coverage", 360, 320)};
}

/// Figures of the charts that are not empty.
std::string figures_html(std::span<const Chart> charts) {
  std::string html;
  for (const Chart& chart : charts)
    if (!chart.series.empty()) html += figure_html(chart);
  return html;
}

std::string matrix_html(const Evaluation& evaluation, const Report& report,
                        const Monitor& monitor) {
  Chart matrix = matrix_chart(evaluation, report, kPageMatrixSide, monitor);
  matrix.title = "Query frames against training frames";
  matrix.width = evaluation.matrix ? 900 : 560;
  return fmt::format(
      "<section id=\"matrix\"><h2>{}</h2>\n{}<output id=\"cell\" class=\"note\"></output>\n"
      "</section>\n",
      evaluation.matrix ? "Scores of all pairs" : "Recognitions of all pairs", figure_html(matrix));
}

std::string tables_html(const Report& report) {
  if (report.frames.by != JudgedBy::ground_truth) return table_html(places_table(report));
  std::string html;
  for (const Table& table : metrics_tables(report)) html += table_html(table);
  Table summary = report_table(report);
  summary.title = "Counts";
  return html + table_html(summary);
}

// "Frames off: ...; 2 of 111 recognitions are off, by 7 frames at most".
Chart off_chart(const Report& report, const Judgment& judgment, const GroundTruth& truth) {
  Chart chart = frames_off_chart(report, judgment, truth);
  size_t all = 0;
  size_t off = 0;
  double most = 0;
  for (const Series& series : chart.series)
    for (const auto& [frame, frames] : series.points) {
      ++all;
      off += frames != 0;
      most = std::max(most, std::abs(frames));
    }
  return sized(
      chart,
      fmt::format("Frames off: recognitions to the closest frame of the same place. {} of "
                  "{} {} off, at most {}",
                  off, all, off == 1 ? "is" : "are", counted(static_cast<size_t>(most), "frame")),
      kPageWidth, 200);
}

void add_queries(Json& data, const Judgment& judgment, const GroundTruth& truth) {
  data["matches"] = Json::array();
  data["scores"] = Json::array();
  Json ranks = Json::array();
  Json off = Json::array();
  std::string recognized(judgment.verdicts.size(), '.');
  for (const QueryOutcome& query : judgment.outcomes.queries) {
    data["matches"].push_back(
        query.best ? Json::array({query.best->sequence, query.best->reference}) : Json());
    data["scores"].push_back(
        query.best ? Json(fmt::format("{:.6g}", score_of_key(query.key, judgment.outcomes.kind)))
                   : Json());
    ranks.push_back(query.rank.value_or(0));
    const auto frames = frames_off(truth, query);
    off.push_back(frames ? Json(*frames) : Json());
    if (is_recognized(judgment, query)) recognized[query.frame] = 'f';
  }
  if (judgment.outcomes.has_ranks) data["ranks"] = ranks;
  if (!judgment.layout.scope.has_places) data["off"] = off;
  data["recognized"] = recognized;
}

/// The margin of the decision; null for decisions without margin, and if it differs by sequence.
Json required_margin(const Outcomes& outcomes) {
  std::set<double> required;
  for (const QueryOutcome& query : outcomes.queries)
    if (query.required_margin) required.insert(*query.required_margin);
  if (outcomes.confidence == Confidence::score || required.size() != 1) return {};
  return *required.begin();
}

/// For each selected frame, its frame of the recording.
void add_sources(Json& data, const GroundTruthScope& scope) {
  const auto is_all = [](const auto& train) { return train.sequence.selection.is_all(); };
  if (const Selection& selection = scope.query.selection; !selection.is_all())
    data["query_sources"] = selection.sources;
  if (std::ranges::all_of(scope.sequences, is_all)) return;
  for (const auto& train : scope.sequences)
    data["train_sources"].push_back(is_all(train) ? Json()
                                                  : Json(train.sequence.selection.sources));
}

// "filter on tuesday (111 frames) in monday (111 frames)".
std::string page_title(const Report& report, const GroundTruthScope& scope) {
  constexpr size_t kMostTrained = 3;  // training sequences
  std::vector<std::string> trained;
  size_t frames = 0;
  for (const auto& train : scope.sequences) {
    if (!train.searched || scope.has_places) continue;
    trained.push_back(
        fmt::format("{} ({})", train.sequence.name, counted(train.sequence.frames, "frame")));
    frames += train.sequence.frames;
  }
  std::string title =
      fmt::format("{} ({})", evaluation_title(report), counted(scope.query.frames, "frame"));
  if (trained.size() > kMostTrained)
    return title +
           fmt::format(" in {} training sequences ({})", trained.size(), counted(frames, "frame"));
  if (!trained.empty()) title += fmt::format(" in {}", fmt::join(trained, ", "));
  return title;
}

bool has_witness(const Evaluation& evaluation) {
  const Result* result = evaluation.result ? evaluation.result->result.get() : nullptr;
  return result != nullptr && result->path && !result->path->witnessed.empty();
}

/// By query: x and y of each inlier in the image of the query and of its best match, as shares
/// of the longer sides.
Json inliers_json(const Judgment& judgment, const FrameImages& images) {
  Json json = Json::object();
  for (const QueryOutcome& query : judgment.outcomes.queries) {
    const auto own = images.query.find(query.frame);
    if (own == images.query.end() || !query.best) continue;
    const auto& references = images.references[query.best->sequence];
    const auto match = references.find(query.best->reference);
    if (match == references.end()) continue;
    Json& lines = json[std::to_string(query.frame)] = Json::array();
    for (const PointPair& pair : inliers(own->second.features, match->second.features)) {
      const auto query_point = pair.query / own->second.working_side;
      const auto train_point = pair.train / match->second.working_side;
      Json line;
      for (const double part :
           {query_point.real(), query_point.imag(), train_point.real(), train_point.imag()})
        line.push_back(std::round(part * 1000) / 1000);
      lines.push_back(std::move(line));
    }
  }
  return json;
}

/// Values per query, the bands of the charts' axes, and counts by threshold.
Json page_data(const Report& report, const Judgment& judgment, const GroundTruth& truth,
               const FrameImages& images, bool with_inliers) {
  Json data;
  const ScoreUnit unit = score_unit(report);
  data["best"] = outcome_letters(report.frames.outcomes);
  data["unit"] = {{"words", unit.words}, {"divisor", unit.divisor}};
  data["judged"] = judgment.by != JudgedBy::nothing;
  data["sequences"] = Json::array();
  for (const auto& train : judgment.layout.scope.sequences)
    data["sequences"].push_back(train.sequence.name);
  add_queries(data, judgment, truth);
  data["images"] = images_json(images);
  if (with_inliers) data["inliers"] = inliers_json(judgment, images);
  add_sources(data, judgment.layout.scope);
  data["columns"] = value_to_json(column_bands(judgment.layout));
  data["rows"] = value_to_json(row_bands(judgment.layout));
  data["train"] = value_to_json(frame_bands(judgment.layout));
  data["positives"] = judgment.single_best.positives;
  data["steps"] = Json::array();
  for (const ThresholdStep& step : threshold_steps(report, judgment, kMostPagePoints))
    data["steps"].push_back({step.threshold, step.accepted[0], step.accepted[1], step.accepted[2]});
  data["order"] = enum_name(confidence_order(judgment.outcomes));
  data["asked"] = required_margin(judgment.outcomes);
  return data;
}

}  // namespace

std::string evaluation_page(const Evaluation& evaluation, const Report& report, const RunInfo& run,
                            const std::string& summary, const FrameSources& sources,
                            const Monitor& monitor) {
  const Judgment& judgment = evaluation.judgment;
  const GroundTruth& truth = evaluation.truth;
  const Gallery gallery =
      make_gallery(judgment, truth, score_unit(report), sources, monitor,
                   {.pictured = kMostPictured, .has_features = has_witness(evaluation)});
  const Chart timeline = path_chart(evaluation, report, monitor);
  const bool has_path = evaluation.result && evaluation.result->result->path;
  Chart margins = sized(margin_chart(report, judgment),
                        fmt::format("Margin of every best match: difference to the runner-up{}",
                                    has_path ? ", reduced for far paths" : ""),
                        kPageWidth, 240);
  std::array<Chart, 2> below = {off_chart(report, judgment, truth), std::move(margins)};
  for (Chart& chart : below) chart.right = layout_of(timeline, true).names_width;
  const std::string matrix =
      has_matrix(evaluation) ? matrix_html(evaluation, report, monitor) : std::string();
  const std::string settings =
      evaluation.result ? settings_text(*evaluation.result->result) + ". " : "";
  Json json = report_json(report);
  Json& made = json["provenance"];
  if (!run.command_line.empty()) made["command_line"] = run.command_line;
  Json& protocol = json["protocol"];
  protocol.erase("ground_truth");                      // the subtitle
  if (truth.is_known) protocol.erase("localization");  // the title of its table
  return fill_page(html::kPage,
                   {{"title", html_escaped(page_title(report, judgment.layout.scope))},
                    {"summary", html_escaped(summary)},
                    {"subtitle", html_escaped(settings + "Ground truth: " + truth.protocol)},
                    {"style", palette_css() + std::string(html::kStyle)},
                    {"script", std::string(html::kScript) + std::string(html::kAnchorScript)},
                    {"disagreements", truth.is_known ? std::string(kDisagreements) : ""},
                    {"tables", tables_html(report)},
                    {"protocol", list_html(protocol)},
                    {"provenance", list_html(json["settings"]) + list_html(made)},
                    {"curves", figures_html(curve_charts(report, judgment))},
                    {"threshold", by_margin(judgment) ? "Margin" : "Threshold"},
                    {"path", figure_html(timeline) + figures_html(below)},
                    {"matrix_link", matrix.empty() ? "" : "<a href=\"#matrix\">Matrix</a> "},
                    {"matrix", matrix},
                    {"gallery_note", html_escaped(gallery.note)},
                    {"kinds", gallery.kinds},
                    {"cards", gallery.cards},
                    {"single", judgment.layout.window_length == 1 ? " single" : ""},
                    {"data", script_json(page_data(report, judgment, truth, gallery.pictured,
                                                   has_witness(evaluation)))}});
}

std::string evaluation_preview(const Evaluation& evaluation, const Report& report,
                               const std::string& summary, const FrameSources& sources,
                               const Monitor& monitor) {
  const Judgment& judgment = evaluation.judgment;
  const Gallery gallery = make_gallery(judgment, evaluation.truth, score_unit(report), sources,
                                       monitor, {3, 5, 1, false});
  const std::string cards = sources.query ? "<div class=\"cards\">" + gallery.cards + "</div>" : "";
  return sections_page(evaluation_title(report), summary,
                       "Ground truth: " + evaluation.truth.protocol,
                       figure_html(path_chart(evaluation, report, monitor)) + cards, {},
                       report_json(report)["provenance"]);
}

}  // namespace vpr
