#include "present/evaluation_charts.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "evaluate/metrics.h"
#include "evaluate/outcomes.h"
#include "evaluate/report.h"
#include "present/chart.h"
#include "present/matrix_chart.h"
#include "present/report_tables.h"
#include "truth/ground_truth.h"

namespace vpr {
namespace {

constexpr size_t kMostPoints = 1000;
constexpr size_t kMostTruth = 465;    // query frames with ground truth
constexpr size_t kMatrixSide = 1000;  // pixels

// In the order of drawing.
constexpr std::array<Meaning, 6> kMarkOrder = {Meaning::weak_unjudged, Meaning::weak_incorrect,
                                               Meaning::weak_correct,  Meaning::unjudged,
                                               Meaning::incorrect,     Meaning::correct};
constexpr std::array<Meaning, 3> kAccepted = {Meaning::correct, Meaning::incorrect,
                                              Meaning::unjudged};

Meaning meaning_of(const Judgment& judgment, const QueryOutcome& query) {
  if (is_recognized(judgment, query)) return meaning_of(query.verdict);
  return query.verdict == Verdict::correct     ? Meaning::weak_correct
         : query.verdict == Verdict::incorrect ? Meaning::weak_incorrect
                                               : Meaning::weak_unjudged;
}

// The known curves of best matches; the dashed one is drawn on the solid one.
std::vector<std::pair<Meaning, const Curve*>> best_match_curves(const Judgment& judgment) {
  const bool by_score = judgment.outcomes.confidence == Confidence::score;
  const Curve* other = judgment.other_best ? &*judgment.other_best : nullptr;
  std::vector<std::pair<Meaning, const Curve*>> curves = {
      {Meaning::best_matches, by_score ? &judgment.single_best : other},
      {Meaning::by_margin, by_score ? other : &judgment.single_best}};
  std::erase_if(curves, [](const auto& curve) { return curve.second == nullptr; });
  return curves;
}

// Adds a point per query for which `y` has a value, in a series per meaning.
template <class Y>
void add_best_matches(Chart& chart, const Judgment& judgment, SeriesMark recognized, const Y& y) {
  for (const Meaning meaning : kMarkOrder) {
    const bool is_strong = std::ranges::find(kAccepted, meaning) != kAccepted.end();
    Series series =
        series_of(meaning, SeriesStyle::points, is_strong ? recognized : SeriesMark::dot);
    for (const QueryOutcome& query : judgment.outcomes.queries)
      if (const std::optional<double> value = y(query);
          value && meaning_of(judgment, query) == meaning)
        series.points.emplace_back(static_cast<double>(query.frame) + 0.5, *value);
    chart.series.push_back(series);
  }
}

// Boxes for the ground truth of about kMostTruth query frames, evenly spaced; a box extends to the
// next of these frames.
Series truth_series(const Judgment& judgment, const GroundTruth& truth,
                    const std::vector<FrameBand>& bands, const Monitor& monitor) {
  Series series = series_of(Meaning::truth, SeriesStyle::boxes);
  const size_t frames = std::min(judgment.layout.scope.query.frames, truth.pairs.size());
  const size_t step = std::max<size_t>(1, (frames + kMostTruth - 1) / kMostTruth);
  for (size_t frame = 0; frame < frames; frame += step) {
    for (const FrameBand& band : bands) {
      check_stop(monitor);
      const size_t end = band.first + band.count;
      for (const LabelStretch& run : label_runs(truth, frame, band.sequence, end)) {
        if (run.label != PlaceLabel::same || run.last < band.first) continue;
        const size_t low = band.at + std::max(run.first, band.first) - band.first;
        series.points.emplace_back(frame, low);
        series.points.emplace_back(std::min(frames, frame + step),
                                   band.at + run.last + 1 - band.first);
      }
    }
  }
  return series;
}

Chart recall_chart(const Report& report, const Judgment& judgment) {
  Chart chart{"recall-at", evaluation_title(report), {"K"}};
  chart.y.label = "recall@K";
  chart.y.range = {0, 1};
  chart.x.range = {1, static_cast<double>(std::max<size_t>(2, judgment.recall_at.back()))};
  Series& series = chart.series.emplace_back(
      Series{"recall@K", {}, SeriesStyle::points, Meaning::best_matches, SeriesMark::disc});
  for (const size_t k : judgment.recall_at) {
    const std::optional<double> recall = recall_at(judgment.outcomes, k);
    if (!recall) continue;  // beyond the shortest list
    series.points.emplace_back(k, *recall);
    chart.x.ticks.push_back({static_cast<double>(k), std::to_string(k)});
  }
  return chart;
}

std::string margin_words(const Report& report) {
  const QuerySettings* settings = report.query_settings();
  return settings == nullptr ? "margin per frame"
                             : fmt::format("margin in {}", score_of(*settings).margin_unit);
}

/// The unit of the threshold's flag.
ScoreUnit threshold_unit(const Report& report, const Judgment& judgment) {
  if (judgment.outcomes.confidence == Confidence::margin) return {margin_words(report)};
  ScoreUnit unit = score_unit(report);
  if (const QuerySettings* settings = report.query_settings())
    unit.words += fmt::format(" ({}{})", score_of(*settings).threshold_symbol,
                              unit.words.ends_with("distance") ? " with --t-r-scale bits" : "");
  return unit;
}

// An index of kAccepted. The verdict of a best match is not none.
size_t accepted_as(const QueryOutcome& query) { return static_cast<size_t>(query.verdict); }

struct RankedMatch {
  double value = 0;  ///< score or margin, by the outcomes' confidence
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

ScoreUnit score_unit(const Report& report) {
  if (const QuerySettings* settings = report.query_settings())
    return score_unit(*settings, report.frames.outcomes.window_length);
  return {std::string(enum_name(report.frames.outcomes.kind))};
}

std::vector<std::pair<double, double>> curve_points(const Curve& curve) {
  std::vector<std::pair<double, double>> points;
  double recall = 0;
  for (const CurvePoint& point : thinned(curve, kMostPoints)) {
    const double precision = Curve::precision(point);
    if (points.empty() || points.back().second != precision) points.emplace_back(recall, precision);
    recall = curve.recall(point);
    if (points.back().first != recall) points.emplace_back(recall, precision);
  }
  return points;
}

std::vector<ChartStretch> verdict_stretches(const std::vector<Verdict>& verdicts) {
  std::vector<ChartStretch> runs;
  for (size_t begin = 0; begin < verdicts.size();) {
    size_t end = begin;
    while (end < verdicts.size() && verdicts[end] == verdicts[begin]) ++end;
    if (verdicts[begin] != Verdict::none)
      runs.push_back(
          {static_cast<double>(begin), static_cast<double>(end), meaning_of(verdicts[begin])});
    begin = end;
  }
  return runs;
}

Chart precision_recall_chart(const std::string& title) {
  Chart chart{std::string(kPrecisionRecall), title, {"recall"}};
  chart.y.label = "precision";
  chart.x.range = chart.y.range = {0, 1};
  return chart;
}

Chart curve_chart(const Report& report, const Judgment& judgment) {
  Chart chart = precision_recall_chart(evaluation_title(report));
  std::vector<std::pair<Meaning, const Curve*>> curves = best_match_curves(judgment);
  if (judgment.all_pairs)
    curves.insert(curves.begin(), {Meaning::all_pairs, &judgment.all_pairs->curve});
  for (const auto& [meaning, curve] : curves) {
    chart.series.push_back(series_of(meaning, SeriesStyle::line));
    chart.series.back().points = curve_points(*curve);
  }
  erase_empty_series(chart);
  return chart;
}

Chart tolerance_chart(const Report& report, const Judgment& judgment, const GroundTruth& truth) {
  constexpr int64_t kMostFrames = 10;
  Chart chart{"recall-tolerance", evaluation_title(report), {"tolerance in training frames"}};
  chart.y.label = "R@1";
  chart.y.range = {0, 1};
  const int64_t most = std::max(kMostFrames, 2 * truth.tolerance_frames);
  chart.x.range = {0, static_cast<double>(most)};
  const uint64_t positives = judgment.single_best.positives;
  if (!truth.is_known || !truth.asked.empty() || truth.applied_tolerance_frames ||
      report.has_places() || positives == 0)
    return chart;
  Series& series = chart.series.emplace_back(
      Series{"R@1", {}, SeriesStyle::points, Meaning::best_matches, SeriesMark::disc});
  GroundTruth at = truth;
  for (at.tolerance_frames = 0; at.tolerance_frames <= most; ++at.tolerance_frames) {
    const auto correct =
        std::ranges::count_if(judgment.outcomes.queries, [&](const QueryOutcome& query) {
          return query.has_match && query.best &&
                 label_of(at, {query.frame, *query.best}) == PlaceLabel::same;
        });
    series.points.emplace_back(static_cast<double>(at.tolerance_frames),
                               static_cast<double>(correct) / static_cast<double>(positives));
  }
  return chart;
}

Chart risk_chart(const Report& report, const Judgment& judgment) {
  Chart chart{"risk-coverage", evaluation_title(report), {"coverage: best matches accepted"}};
  chart.y.label = "risk: share of mistakes among them";
  chart.x.range = chart.y.range = {0, 1};
  for (const auto& [meaning, curve] : best_match_curves(judgment)) {
    if (!curve->is_measurable()) continue;
    chart.series.push_back(series_of(meaning, SeriesStyle::line));
    chart.series.back().points = risk_coverage_points(*curve);
  }
  return chart;
}

Chart margin_chart(const Report& report, const Judgment& judgment) {
  Chart chart{"margins", evaluation_title(report)};
  chart.x = frame_axis({{"", 0, 0, 0, judgment.verdicts.size()}}, "query frame", false);
  chart.y.label = margin_words(report);
  add_best_matches(chart, judgment, SeriesMark::dot,
                   [](const QueryOutcome& query) { return query.margin; });
  Series required = series_of(Meaning::required_margin, SeriesStyle::line);
  for (const QueryOutcome& query : judgment.outcomes.queries)
    if (query.margin && query.required_margin)
      required.points.emplace_back(static_cast<double>(query.frame) + 0.5, *query.required_margin);
  chart.series.push_back(required);
  erase_empty_series(chart);
  chart.has_cursor = true;
  chart.width = 1000;
  return chart;
}

std::optional<int64_t> frames_off(const GroundTruth& truth, const QueryOutcome& query) {
  std::optional<int64_t> off;
  if (!query.best || query.frame >= truth.pairs.size()) return off;
  const int64_t reference = static_cast<int64_t>(query.best->reference);
  for (const GroundTruth::Pair& pair : truth.pairs_of(query.frame, query.best->sequence)) {
    if (pair.label != PlaceLabel::same) continue;
    const int64_t from = reference - std::clamp<int64_t>(reference, pair.first, pair.last());
    if (!off || std::abs(from) < std::abs(*off)) off = from;
  }
  return off;
}

Chart frames_off_chart(const Report& report, const Judgment& judgment, const GroundTruth& truth) {
  Chart chart{"frames-off", evaluation_title(report)};
  if (report.has_places()) return chart;
  add_best_matches(chart, judgment, SeriesMark::dot,
                   [&](const QueryOutcome& query) -> std::optional<double> {
                     const auto off = frames_off(truth, query);
                     if (!off || !is_recognized(judgment, query)) return std::nullopt;
                     return static_cast<double>(*off);
                   });
  erase_empty_series(chart);
  double most = 0;
  for (const Series& series : chart.series)
    for (const auto& [frame, off] : series.points) most = std::max(most, std::abs(off));
  if (most == 0) chart.series.clear();
  chart.x = frame_axis({{"", 0, 0, 0, judgment.verdicts.size()}}, "query frame", false);
  chart.y.label = "training frames ahead of the ground truth";
  chart.y.range = {-most, most};
  chart.has_cursor = true;
  chart.width = 1000;
  return chart;
}

bool has_matrix(const Evaluation& evaluation) {
  if (evaluation.matrix) return true;
  const auto& queries = evaluation.judgment.outcomes.queries;
  return std::ranges::any_of(evaluation.judgment.recognized, [&](const MatchedFrame& one) {
    return queries.at(one.query).best != one.match;
  });
}

Chart timeline_chart(const Report& report, const Judgment& judgment, const GroundTruth& truth,
                     const Monitor& monitor) {
  const std::vector<FrameBand> bands = frame_bands(judgment.layout);
  Chart chart{"timeline", evaluation_title(report)};
  chart.x =
      frame_axis({{"", 0, 0, 0, judgment.verdicts.size()}}, "query frame (bar: recognized)", false);
  chart.y = frame_axis(bands, reference_word(report), false);
  chart.series.push_back(truth_series(judgment, truth, bands, monitor));
  add_best_matches(chart, judgment, SeriesMark::disc,
                   [&](const QueryOutcome& query) -> std::optional<double> {
                     if (!query.best) return std::nullopt;
                     return static_cast<double>(position_of(bands, *query.best)) + 0.5;
                   });
  erase_empty_series(chart);
  name_borders(chart);
  chart.runs = verdict_stretches(judgment.verdicts);
  chart.has_cursor = true;
  chart.width = 1000;
  return chart;
}

Chart threshold_chart(const Report& report, const Judgment& judgment) {
  const ScoreUnit unit = threshold_unit(report, judgment);
  const bool is_distance = confidence_order(judgment.outcomes) == ScoreOrder::distance;
  Chart chart{
      "thresholds", evaluation_title(report), {(is_distance ? "largest " : "least ") + unit.words}};
  chart.y.label = "best matches accepted";
  for (const Meaning meaning : kAccepted)
    chart.series.push_back(series_of(meaning, SeriesStyle::line));
  const std::vector<RankedMatch> order = strictest_first(judgment);
  const auto threshold = [&](const RankedMatch& match) { return match.value / unit.divisor; };
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
  const ScoreUnit unit = threshold_unit(report, judgment);
  std::vector<ThresholdStep> steps;
  ThresholdStep step;
  for (const RankedMatch& match : strictest_first(judgment)) {
    const double threshold = match.value / unit.divisor;
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
  const PixelGrid grid(judgment.layout, most_pixels);
  const std::vector<double> scores =
      evaluation.matrix ? pixel_scores(*evaluation.matrix, grid, monitor) : std::vector<double>{};
  return matrix_chart(judgment, evaluation.truth, grid, scores, reference_word(report),
                      score_unit(report), monitor);
}

void draw_evaluation(const Evaluation& evaluation, const Report& report,
                     const std::filesystem::path& folder, const FigureSettings& figure,
                     const Monitor& monitor) {
  const Judgment& judgment = evaluation.judgment;
  std::vector<Chart> charts = {curve_chart(report, judgment), risk_chart(report, judgment)};
  if (judgment.outcomes.has_ranks && judgment.single_best.positives > 0)
    charts.push_back(recall_chart(report, judgment));
  charts.push_back(tolerance_chart(report, judgment, evaluation.truth));
  charts.push_back(timeline_chart(report, judgment, evaluation.truth, monitor));
  charts.push_back(frames_off_chart(report, judgment, evaluation.truth));
  charts.push_back(margin_chart(report, judgment));
  for (const Chart& chart : charts)
    if (!chart.series.empty()) draw_chart(in_figure(chart, figure), folder);
  if (!has_matrix(evaluation)) return;
  Chart chart = matrix_chart(evaluation, report, kMatrixSide, monitor);
  chart.title = evaluation_title(report);
  draw_chart(in_figure(chart, figure), folder);
}

}  // namespace vpr
