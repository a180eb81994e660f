#include "present/evaluation_charts.h"

#include <array>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "evaluate/metrics.h"
#include "evaluate/outcomes.h"
#include "match/score_kernels.h"
#include "present/evaluation_tables.h"
#include "present/score_matrix.h"
#include "truth/ground_truth.h"

namespace vpr {
namespace {

constexpr size_t kMostPoints = 1000;
constexpr size_t kMostTruth = 465;    // frames whose ground truth is drawn
constexpr size_t kMatrixSide = 1000;  // pixels

// What marks mean, in the order of drawing.
constexpr std::array<Meaning, 6> kMarkOrder = {Meaning::weak_unjudged, Meaning::weak_wrong,
                                               Meaning::weak_right,    Meaning::unjudged,
                                               Meaning::wrong,         Meaning::right};

// A recognition, or a best match that is not recognized (weak).
Meaning meaning_of(const Judgment& judgment, const QueryOutcome& query) {
  const bool is_strong = is_recognized(judgment, query);
  if (query.verdict == Verdict::correct) return is_strong ? Meaning::right : Meaning::weak_right;
  if (query.verdict == Verdict::incorrect) return is_strong ? Meaning::wrong : Meaning::weak_wrong;
  return is_strong ? Meaning::unjudged : Meaning::weak_unjudged;
}

Series curve_series(Meaning meaning, const Curve& curve) {
  Series series = series_of(meaning, SeriesStyle::line);
  series.points = curve_points(curve, kMostPoints);
  return series;
}

void leave_out_empty(Chart& chart) {
  std::erase_if(chart.series, [](const Series& series) { return series.points.empty(); });
}

// The ground truth of about kMostTruth query frames, evenly spaced, as boxes; each frame stands for
// those up to the next one.
Series truth_series(const Judgment& judgment, const GroundTruth& truth,
                    const std::vector<FrameBand>& bands, const Monitor& monitor) {
  Series series = series_of(Meaning::truth, SeriesStyle::boxes);
  const size_t frames = std::min(judgment.layout.scope.query.frames, truth.pairs.size());
  const size_t step = std::max<size_t>(1, (frames + kMostTruth - 1) / kMostTruth);
  for (size_t frame = 0; frame < frames; frame += step) {
    for (const FrameBand& band : bands) {
      check_stop(monitor);
      const size_t end = band.first_frame + band.count;
      for (const LabelRun& run : label_runs(truth, frame, band.sequence, end)) {
        if (run.label != PlaceLabel::same || run.last < band.first_frame) continue;
        const size_t low = band.at + std::max(run.first, band.first_frame) - band.first_frame;
        series.points.emplace_back(frame, low);
        series.points.emplace_back(std::min(frames, frame + step),
                                   band.at + run.last + 1 - band.first_frame);
      }
    }
  }
  return series;
}

Chart recall_chart(const Report& report, const Judgment& judgment) {
  Chart chart{"recall-at", evaluation_title(report), {"K"}};
  chart.y.label = "recall@K";
  Series& series = chart.series.emplace_back(
      Series{"recall@K", {}, SeriesStyle::line_and_points, Meaning::best_matches});
  for (size_t k = 1; k <= kRecallAt.back(); ++k)
    series.points.emplace_back(k, *recall_at(judgment.outcomes, k));
  return chart;
}

/// How a chart shows scores: divided, and called so.
struct ScoreAxis {
  std::string label;
  double divisor = 1;
};

/// Scores as thresholds are given: t_r as a mean frame distance or as mean z, t_p, or as they are.
ScoreAxis score_axis(const Report& report, const Judgment& judgment) {
  if (judgment.outcomes.confidence == Confidence::margin) return {"the margin per frame", 1};
  const auto length = static_cast<double>(judgment.layout.window_length);
  const QuerySettings* settings = report.query_settings();
  if (settings == nullptr) return {score_words(report), 1};
  if (report.has_places()) return {"the probability t_p", 1};
  if (std::get<SequenceQuerySettings>(*settings).score != Score::raw)
    return {"the mean z (t_r)", length * kScoreUnit};
  return {"a mean frame distance (t_r with --t-r-scale bits)", length};
}

constexpr std::array<Meaning, 3> kAccepted = {Meaning::right, Meaning::wrong, Meaning::unjudged};

size_t accepted_as(const QueryOutcome& query) {
  return query.verdict == Verdict::correct ? 0 : query.verdict == Verdict::incorrect ? 1 : 2;
}

/// A best match, by the confidence in force.
struct RankedMatch {
  double value = 0;
  const QueryOutcome* query = nullptr;
};

std::vector<RankedMatch> strictest_first(const Judgment& judgment) {
  const Outcomes& outcomes = judgment.outcomes;
  const ScoreOrder kind = confidence_order(outcomes);
  std::vector<RankedMatch> order;
  for (const QueryOutcome& query : outcomes.queries) {
    const double value = score_of_key(confidence_key(query, judgment.outcomes.confidence), kind);
    if (query.best && std::isfinite(value)) order.push_back({value, &query});
  }
  std::stable_sort(order.begin(), order.end(), [&](const RankedMatch& a, const RankedMatch& b) {
    return is_better(a.value, b.value, kind);
  });
  return order;
}

}  // namespace

std::vector<std::pair<double, double>> curve_points(const Curve& curve, size_t most) {
  std::vector<std::pair<double, double>> points;
  for (const CurvePoint& point : thinned(curve, most))
    points.emplace_back(curve.recall(point), Curve::precision(point));
  return points;
}

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

Chart precision_recall_chart(const std::string& title) {
  Chart chart{"precision-recall", title, {"recall"}};
  chart.y.label = "precision";
  chart.x.range = chart.y.range = {0, 1};
  return chart;
}

Chart curve_chart(const Report& report, const Judgment& judgment) {
  Chart chart = precision_recall_chart(evaluation_title(report));
  if (judgment.all_pairs)
    chart.series.push_back(curve_series(Meaning::all_pairs, judgment.all_pairs->curve));
  const bool by_score = judgment.outcomes.confidence == Confidence::score;
  chart.series.push_back(
      curve_series(by_score ? Meaning::best_matches : Meaning::by_margin, judgment.single_best));
  if (judgment.other_best)
    chart.series.push_back(
        curve_series(by_score ? Meaning::by_margin : Meaning::best_matches, *judgment.other_best));
  leave_out_empty(chart);
  return chart;
}

Chart risk_chart(const Report& report, const Judgment& judgment) {
  Chart chart{"risk-coverage", evaluation_title(report), {"coverage: best matches accepted"}};
  chart.y.label = "risk: share of mistakes among them";
  chart.x.range = chart.y.range = {0, 1};
  Meaning meaning = judgment.outcomes.confidence == Confidence::score ? Meaning::best_matches
                                                                      : Meaning::by_margin;
  for (const Curve* curve :
       {&judgment.single_best, judgment.other_best ? &*judgment.other_best : nullptr}) {
    if (curve == nullptr || curve->to_find == 0) continue;
    Series& series = chart.series.emplace_back(series_of(meaning, SeriesStyle::line));
    series.points = risk_coverage_points(*curve);
    meaning = meaning == Meaning::by_margin ? Meaning::best_matches : Meaning::by_margin;
  }
  return chart;
}

Chart margin_chart(const Report& report, const Judgment& judgment) {
  Chart chart{"margins", evaluation_title(report)};
  chart.x = frame_axis({{"", 0, 0, 0, judgment.fixes.size()}}, "query frame", false);
  chart.y.label = "margin, a frame";
  for (const Meaning meaning : kMarkOrder) {
    Series series = series_of(meaning, SeriesStyle::points, SeriesMark::dot);
    for (const QueryOutcome& query : judgment.outcomes.queries)
      if (query.margin && meaning_of(judgment, query) == meaning)
        series.points.emplace_back(static_cast<double>(query.frame) + 0.5, *query.margin);
    chart.series.push_back(series);
  }
  Series asked = series_of(Meaning::asked_margin, SeriesStyle::line);
  for (const QueryOutcome& query : judgment.outcomes.queries)
    if (query.margin && query.asked_margin)
      asked.points.emplace_back(static_cast<double>(query.frame) + 0.5, *query.asked_margin);
  chart.series.push_back(asked);
  leave_out_empty(chart);
  chart.width = 1000;
  return chart;
}

Chart timeline_chart(const Report& report, const Judgment& judgment, const GroundTruth& truth,
                     const Monitor& monitor) {
  const std::vector<FrameBand> bands = frame_bands(judgment.layout);
  Chart chart{"timeline", evaluation_title(report)};
  chart.x = frame_axis({{"", 0, 0, 0, judgment.fixes.size()}}, "query frame", false);
  chart.y = frame_axis(bands, reference_word(report), false);
  chart.series.push_back(truth_series(judgment, truth, bands, monitor));
  for (const Meaning meaning : kMarkOrder) {
    const bool is_strong =
        meaning == Meaning::right || meaning == Meaning::wrong || meaning == Meaning::unjudged;
    Series series =
        series_of(meaning, SeriesStyle::points, is_strong ? SeriesMark::disc : SeriesMark::dot);
    for (const QueryOutcome& query : judgment.outcomes.queries)
      if (query.best && meaning_of(judgment, query) == meaning)
        series.points.emplace_back(static_cast<double>(query.frame) + 0.5,
                                   static_cast<double>(position_of(bands, *query.best)) + 0.5);
    chart.series.push_back(series);
  }
  leave_out_empty(chart);
  chart.runs = fix_runs(judgment.fixes);
  chart.runs_label = "fixes";
  chart.width = 1000;
  return chart;
}

std::vector<Meaning> meanings_of(const Chart& chart) {
  std::set<Meaning> found;
  for (const Series& series : chart.series)
    if (series.meaning) found.insert(*series.meaning);
  for (const ChartRun& run : chart.runs) found.insert(run.meaning);
  return {found.begin(), found.end()};
}

Chart threshold_chart(const Report& report, const Judgment& judgment) {
  const ScoreAxis axis = score_axis(report, judgment);
  const bool is_distance = confidence_order(judgment.outcomes) == ScoreOrder::distance;
  Chart chart{"thresholds",
              evaluation_title(report),
              {is_distance ? "up to " + axis.label : axis.label + ", or more"}};
  chart.y.label = "best matches accepted";
  for (const Meaning meaning : kAccepted)
    chart.series.push_back(series_of(meaning, SeriesStyle::line));
  const std::vector<RankedMatch> order = strictest_first(judgment);
  const auto threshold = [&](const RankedMatch& match) { return match.value / axis.divisor; };
  if (!order.empty() && threshold(order.front()) != threshold(order.back()))
    chart.x.range = {threshold(order.front()), threshold(order.back())};
  std::array<size_t, 3> counts = {};
  const size_t thinning = std::max<size_t>(1, order.size() / kMostPoints);
  for (size_t i = 0; i < order.size(); ++i) {
    ++counts[accepted_as(*order[i].query)];
    if (i % thinning != 0 && i + 1 < order.size()) continue;
    for (size_t kind = 0; kind < kAccepted.size(); ++kind)
      chart.series[kind].points.emplace_back(threshold(order[i]), counts[kind]);
  }
  std::erase_if(chart.series, [](const Series& series) {
    return series.points.empty() || series.points.back().second == 0;
  });
  return chart;
}

std::vector<ThresholdStep> threshold_steps(const Report& report, const Judgment& judgment,
                                           size_t most) {
  const ScoreAxis axis = score_axis(report, judgment);
  std::vector<ThresholdStep> steps;
  ThresholdStep step;
  for (const RankedMatch& match : strictest_first(judgment)) {
    const double threshold = match.value / axis.divisor;
    if (!steps.empty() && steps.back().threshold == threshold) steps.pop_back();
    step.threshold = threshold;
    ++step.accepted[accepted_as(*match.query)];
    steps.push_back(step);
  }
  std::vector<ThresholdStep> kept;
  const size_t thinning = std::max<size_t>(1, steps.size() / most);
  for (size_t i = 0; i < steps.size(); ++i)
    if (i % thinning == 0 || i + 1 == steps.size()) kept.push_back(steps[i]);
  return kept;
}

Chart matrix_chart(const Evaluation& evaluation, const Report& report, size_t most_pixels,
                   const Monitor& monitor) {
  const Judgment& judgment = evaluation.judgment;
  const ScoreMatrix* matrix = evaluation.matrix ? &*evaluation.matrix : nullptr;
  return matrix_chart(judgment.layout,
                      draw_scores(judgment, evaluation.truth, matrix, most_pixels, monitor),
                      reference_word(report), score_words(report));
}

void draw_evaluation(const Evaluation& evaluation, const Report& report,
                     const std::filesystem::path& folder, const Monitor& monitor) {
  const Judgment& judgment = evaluation.judgment;
  std::vector<Chart> charts = {curve_chart(report, judgment), risk_chart(report, judgment)};
  if (judgment.outcomes.has_ranks && judged_queries(judgment.outcomes) > 0)
    charts.push_back(recall_chart(report, judgment));
  charts.push_back(timeline_chart(report, judgment, evaluation.truth, monitor));
  charts.push_back(margin_chart(report, judgment));
  for (const Chart& chart : charts)
    if (!chart.series.empty()) draw_chart(chart, folder);
  Chart chart = matrix_chart(evaluation, report, kMatrixSide, monitor);
  chart.title = evaluation_title(report);
  draw_chart(chart, folder);
}

}  // namespace vpr
