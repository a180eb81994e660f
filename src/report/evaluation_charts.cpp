#include "report/evaluation_charts.h"

#include <array>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "base/json.h"
#include "evaluation/metrics.h"
#include "evaluation/outcomes.h"
#include "report/evaluation_report.h"
#include "report/frame_axis.h"
#include "report/metrics_report.h"
#include "report/score_picture.h"
#include "report/timeline.h"

namespace vpr {
namespace {

constexpr size_t kMostPoints = 1000;
constexpr size_t kMostTruth = 465;    // frames whose ground truth is drawn
constexpr size_t kMatrixSide = 1000;  // pixels
constexpr size_t kMostTicks = 10;

Series curve_series(Meaning meaning, const Curve& curve) {
  Series series = series_of(meaning, SeriesStyle::line);
  for (const CurvePoint& point : thinned(curve, kMostPoints))
    series.points.emplace_back(curve.recall(point), Curve::precision(point));
  return series;
}

void leave_out_empty(Chart& chart) {
  std::erase_if(chart.series, [](const Series& series) { return series.points.empty(); });
}

/// An axis that counts the frames of bands; `is_down`: from above.
ChartAxis frame_axis(const std::vector<FrameBand>& bands, const std::string& label, bool is_down) {
  ChartAxis axis{label};
  const double end = std::max<double>(1, static_cast<double>(length_of(bands)));
  axis.range = is_down ? std::pair(end, 0.0) : std::pair(0.0, end);
  for (const AxisTick& tick : ticks_of(bands, kMostTicks))
    axis.ticks.push_back({tick.position, std::to_string(tick.frame)});
  for (const FrameBand& band : bands)
    if (!band.name.empty()) axis.bands.push_back({static_cast<double>(band.at), band.name});
  return axis;
}

Series truth_series(const Judgement& judgement, const GroundTruth& truth,
                    const std::vector<FrameBand>& bands, const Monitor& monitor) {
  Series series = series_of(Meaning::truth, SeriesStyle::boxes);
  for (const TruthBox& box : truth_boxes(judgement, truth, bands, kMostTruth, monitor)) {
    series.points.emplace_back(box.begin, box.low);
    series.points.emplace_back(box.end, box.high);
  }
  return series;
}

/// Runs of frames with the same fix.
std::vector<ChartRun> fix_runs(const std::vector<Fix>& fixes) {
  std::vector<ChartRun> runs;
  for (size_t begin = 0; begin < fixes.size();) {
    size_t end = begin;
    while (end < fixes.size() && fixes[end] == fixes[begin]) ++end;
    if (fixes[begin] != Fix::none)
      runs.push_back(
          {static_cast<double>(begin), static_cast<double>(end), meaning_of(fixes[begin])});
    begin = end;
  }
  return runs;
}

Chart recall_chart(const Json& report, const Judgement& judgement) {
  Chart chart{"recall-at", evaluation_title(report), {"K"}};
  chart.y.label = "recall@K";
  Series& series = chart.series.emplace_back(
      Series{"recall@K", {}, SeriesStyle::line_and_points, Meaning::best_matches});
  for (size_t k = 1; k <= kRecallAt.back(); ++k)
    series.points.emplace_back(k, *recall_at(judgement.outcomes, k));
  return chart;
}

}  // namespace

Chart curve_chart(const Json& report, const Judgement& judgement) {
  Chart chart{"precision-recall", evaluation_title(report), {"recall"}};
  chart.y.label = "precision";
  chart.x.range = chart.y.range = {0, 1};
  if (judgement.all_pairs)
    chart.series.push_back(curve_series(Meaning::all_pairs, judgement.all_pairs->curve));
  const bool by_score = judgement.outcomes.confidence == Confidence::score;
  chart.series.push_back(
      curve_series(by_score ? Meaning::best_matches : Meaning::by_margin, judgement.single_best));
  if (judgement.other_best)
    chart.series.push_back(
        curve_series(by_score ? Meaning::by_margin : Meaning::best_matches, *judgement.other_best));
  leave_out_empty(chart);
  return chart;
}

Chart risk_chart(const Json& report, const Judgement& judgement) {
  Chart chart{"risk-coverage", evaluation_title(report), {"coverage: best matches accepted"}};
  chart.y.label = "risk: share of mistakes among them";
  chart.x.range = chart.y.range = {0, 1};
  Meaning meaning = judgement.outcomes.confidence == Confidence::score ? Meaning::best_matches
                                                                       : Meaning::by_margin;
  for (const Curve* curve :
       {&judgement.single_best, judgement.other_best ? &*judgement.other_best : nullptr}) {
    if (curve == nullptr || curve->to_find == 0) continue;
    Series& series = chart.series.emplace_back(series_of(meaning, SeriesStyle::line));
    series.points = risk_coverage_points(*curve);
    meaning = meaning == Meaning::by_margin ? Meaning::best_matches : Meaning::by_margin;
  }
  return chart;
}

Chart margin_chart(const Json& report, const Judgement& judgement) {
  Chart chart{"margins", evaluation_title(report)};
  chart.x = frame_axis({{"", 0, 0, 0, judgement.fixes.size()}}, "query frame", false);
  chart.y.label = "margin, a frame";
  for (const Meaning meaning : kMarkOrder) {
    Series series = series_of(meaning, SeriesStyle::points, SeriesMark::dot);
    for (const QueryOutcome& query : judgement.outcomes.queries)
      if (query.margin && meaning_of(judgement, query) == meaning)
        series.points.emplace_back(static_cast<double>(query.frame) + 0.5, *query.margin);
    chart.series.push_back(series);
  }
  Series asked = series_of(Meaning::asked_margin, SeriesStyle::line);
  for (const QueryOutcome& query : judgement.outcomes.queries)
    if (query.margin && query.asked_margin)
      asked.points.emplace_back(static_cast<double>(query.frame) + 0.5, *query.asked_margin);
  chart.series.push_back(asked);
  leave_out_empty(chart);
  chart.width = 1000;
  return chart;
}

Chart timeline_chart(const Json& report, const Judgement& judgement, const GroundTruth& truth,
                     const Monitor& monitor) {
  const std::vector<FrameBand> bands = frame_bands(judgement.layout);
  Chart chart{"timeline", evaluation_title(report)};
  chart.x = frame_axis({{"", 0, 0, 0, judgement.fixes.size()}}, "query frame", false);
  chart.y = frame_axis(bands, reference_word(report), false);
  chart.series.push_back(truth_series(judgement, truth, bands, monitor));
  const std::vector<TimelineMark> marks = timeline_marks(judgement, bands);
  for (const Meaning meaning : kMarkOrder) {
    Series series = series_of(meaning, SeriesStyle::points,
                              is_weak(meaning) ? SeriesMark::dot : SeriesMark::disc);
    for (const TimelineMark& mark : marks)
      if (mark.meaning == meaning)
        series.points.emplace_back(static_cast<double>(mark.frame) + 0.5,
                                   static_cast<double>(mark.position) + 0.5);
    chart.series.push_back(series);
  }
  leave_out_empty(chart);
  chart.runs = fix_runs(judgement.fixes);
  chart.runs_label = "fixes";
  chart.width = 1000;
  return chart;
}

Chart matrix_chart(const ScoreLayout& layout, const ScorePicture& picture,
                   const std::string& reference_word, const std::string& score_words) {
  Chart chart{"matrix", ""};
  chart.x = frame_axis(column_bands(layout), reference_word, false);
  chart.y = frame_axis(row_bands(layout), "query frame, downwards", true);
  chart.image = picture.image;
  chart.image->grey_label = score_words;
  for (const Meaning meaning : picture.shown)
    chart.series.push_back(series_of(meaning, SeriesStyle::points, SeriesMark::square));
  return chart;
}

Chart result_matrix_chart(const Result& result, const RowPixels& pixels, const GroundTruth* truth,
                          const Monitor& monitor) {
  const GroundTruth known = truth != nullptr ? *truth : unknown_ground_truth(scope_of(result));
  const Judgement judgement = judge(result, known, {}, monitor);
  const ScorePicture picture =
      draw_scores(judgement, known, pixels.grid(),
                  pixels.scores(result.score().offset(result.window_length())), monitor);
  Chart chart =
      matrix_chart(judgement.layout, picture, "training frame", std::string(result.score().title));
  chart.title = fmt::format("{} on {}, c_l {}", method_of(result.settings), result.query_name,
                            result.window_length());
  return chart;
}

std::vector<Meaning> meanings_of(const Chart& chart) {
  std::set<Meaning> found;
  for (const Series& series : chart.series)
    if (series.meaning) found.insert(*series.meaning);
  for (const ChartRun& run : chart.runs) found.insert(run.meaning);
  return {found.begin(), found.end()};
}

void draw_evaluation(const Json& report, const Judgement& judgement, const GroundTruth& truth,
                     const ScoreMatrix* matrix, const std::filesystem::path& folder,
                     const Monitor& monitor) {
  std::vector<Chart> charts = {curve_chart(report, judgement), risk_chart(report, judgement)};
  if (judgement.outcomes.has_ranks && judged_queries(judgement.outcomes) > 0)
    charts.push_back(recall_chart(report, judgement));
  charts.push_back(timeline_chart(report, judgement, truth, monitor));
  charts.push_back(margin_chart(report, judgement));
  for (const Chart& chart : charts)
    if (!chart.series.empty()) draw_chart(chart, folder);
  const ScorePicture picture = draw_scores(judgement, truth, matrix, kMatrixSide, monitor);
  Chart chart =
      matrix_chart(judgement.layout, picture, reference_word(report), score_words(report));
  chart.title = evaluation_title(report);
  draw_chart(chart, folder);
}

}  // namespace vpr
