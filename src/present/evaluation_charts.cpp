#include "present/evaluation_charts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "evaluate/metrics.h"
#include "evaluate/outcomes.h"
#include "match/score_kernels.h"
#include "present/chart.h"
#include "present/evaluation_report.h"
#include "present/score_matrix.h"
#include "truth/ground_truth.h"

namespace vpr {
namespace {

Series wall_lines(const RouteMap& map, const std::string& floor) {
  Series walls = series_of(Meaning::wall, SeriesStyle::line);
  for (const WallLine& wall : map.walls) {
    if (wall.from.floor != floor) continue;
    walls.points.insert(walls.points.end(),
                        {{wall.from.x, wall.from.y}, {wall.to.x, wall.to.y}, kChartGap});
  }
  return walls;
}

/// A wide line, on which the query's dots are visible.
Series train_lines(const RouteMap& map, const std::string& floor) {
  Series train = series_of(Meaning::train_path, SeriesStyle::wide_line);
  for (const auto& sequence : map.train) {
    for (const auto& at : sequence)
      train.points.push_back(at && at->floor == floor ? std::pair(at->x, at->y) : kChartGap);
    train.points.push_back(kChartGap);
  }
  if (std::ranges::all_of(train.points, [](const auto& point) { return std::isnan(point.first); }))
    train.points.clear();
  return train;
}

// Query frames and training places, in the order of drawing.
constexpr std::array<std::pair<Meaning, SeriesMark>, 7> kPoints = {
    {{Meaning::unmapped, SeriesMark::circle},
     {Meaning::no_valid_window, SeriesMark::dot},
     {Meaning::missed, SeriesMark::dot},
     {Meaning::place, SeriesMark::square},
     {Meaning::unjudged, SeriesMark::disc},
     {Meaning::right, SeriesMark::disc},
     {Meaning::wrong, SeriesMark::cross}}};

Series frame_points(const RouteMap& map, const MapPanel& panel, const std::string& floor,
                    Meaning meaning, SeriesMark mark) {
  Series frames = series_of(meaning, SeriesStyle::points, mark);
  for (size_t frame = 0; frame < map.query.size(); ++frame) {
    const auto& at = map.query[frame];
    if (at && at->floor == floor && panel.meanings[frame] == meaning)
      frames.points.emplace_back(at->x, at->y);
  }
  return frames;
}

Chart panel_chart(const RouteMap& map, const MapPanel& panel, const std::string& floor) {
  std::vector<Series> series = {train_lines(map, floor), wall_lines(map, floor)};
  for (const auto& [meaning, mark] : kPoints) {
    series.push_back(frame_points(map, panel, floor, meaning, mark));
    if (meaning != Meaning::place || !panel.shows_places) continue;
    for (const RoutePoint& place : map.places)
      if (place.floor == floor) series.back().points.emplace_back(place.x, place.y);
  }
  return plan_chart("", floor.empty() ? panel.title : fmt::format("{}, {}", panel.title, floor),
                    std::move(series));
}

// Below the lines; empty if these are one point.
Series scale_bar(const std::vector<Series>& lines) {
  double left = std::numeric_limits<double>::infinity();
  double right = -left;
  double bottom = left;
  double top = -left;
  for (const Series& drawn : lines)
    for (const auto& [x, y] : drawn.points) {
      if (std::isnan(x)) continue;
      left = std::min(left, x);
      right = std::max(right, x);
      bottom = std::min(bottom, y);
      top = std::max(top, y);
    }
  Series bar{"", {}, SeriesStyle::bar, Meaning::wall};
  if (right <= left && top <= bottom) return bar;
  const double size = std::max(right - left, top - bottom);
  const auto meters = static_cast<double>(round_step(static_cast<size_t>(size), 4));
  const double y = bottom - 0.06 * size;
  bar.points = {{left, y}, {left + meters, y}};
  bar.labels = {"", fmt::format("{} m", meters)};
  return bar;
}

constexpr size_t kMostPoints = 1000;
constexpr size_t kMostTruth = 465;    // query frames with ground truth
constexpr size_t kMatrixSide = 1000;  // pixels

// In the order of drawing.
constexpr std::array<Meaning, 6> kMarkOrder = {Meaning::weak_unjudged, Meaning::weak_wrong,
                                               Meaning::weak_right,    Meaning::unjudged,
                                               Meaning::wrong,         Meaning::right};
constexpr std::array<Meaning, 3> kAccepted = {Meaning::right, Meaning::wrong, Meaning::unjudged};

Meaning meaning_of(const Judgment& judgment, const QueryOutcome& query) {
  const bool is_strong = is_recognized(judgment, query);
  if (query.verdict == Verdict::correct) return is_strong ? Meaning::right : Meaning::weak_right;
  if (query.verdict == Verdict::incorrect) return is_strong ? Meaning::wrong : Meaning::weak_wrong;
  return is_strong ? Meaning::unjudged : Meaning::weak_unjudged;
}

// The curves of best matches: by the outcomes' confidence, then by the other one.
std::vector<std::pair<Meaning, const Curve*>> best_match_curves(const Judgment& judgment) {
  const bool by_score = judgment.outcomes.confidence == Confidence::score;
  std::vector<std::pair<Meaning, const Curve*>> curves = {
      {by_score ? Meaning::best_matches : Meaning::by_margin, &judgment.single_best}};
  if (judgment.other_best)
    curves.emplace_back(by_score ? Meaning::by_margin : Meaning::best_matches,
                        &*judgment.other_best);
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

struct ScoreAxis {
  std::string label;
  double divisor = 1;  ///< of scores
};

/// The unit of the threshold's flag.
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

size_t accepted_as(const QueryOutcome& query) {
  return query.verdict == Verdict::correct ? 0 : query.verdict == Verdict::incorrect ? 1 : 2;
}

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

Chart plan_chart(const std::string& file, const std::string& title, std::vector<Series> series) {
  Chart chart{file, title};
  chart.is_plan = true;
  chart.y.from_zero = false;
  chart.width = 675;
  chart.series = std::move(series);
  chart.series.push_back(scale_bar(chart.series));
  erase_empty_series(chart);
  return chart;
}

std::vector<Meaning> meanings_of(const Judgment& judgment, const GroundTruth& truth) {
  std::vector<Meaning> meanings;
  for (size_t frame = 0; frame < judgment.verdicts.size(); ++frame)
    meanings.push_back(truth.has_match(frame) ? Meaning::no_valid_window : Meaning::unmapped);
  for (const QueryOutcome& query : judgment.outcomes.queries)
    if (query.has_match && query.verdict != Verdict::unreadable)
      meanings[query.frame] = Meaning::missed;
  for (size_t frame = 0; frame < judgment.verdicts.size(); ++frame)
    if (judgment.verdicts[frame] != FrameVerdict::none)
      meanings[frame] = meaning_of(judgment.verdicts[frame]);
  return meanings;
}

std::vector<Chart> route_charts(const RouteMap& map, const std::vector<MapPanel>& panels,
                                const Monitor& monitor) {
  std::vector<std::string> floors;
  std::set<std::string> known;
  for (const auto& at : map.query)
    if (at && known.insert(at->floor).second) floors.push_back(at->floor);
  std::vector<Chart> charts;
  for (const std::string& floor : floors)
    for (const MapPanel& panel : panels) {
      check_stop(monitor);
      charts.push_back(panel_chart(map, panel, floor));
    }
  return charts;
}

void draw_route_map(const RouteMap& map, const std::vector<MapPanel>& panels,
                    const std::filesystem::path& folder, const Monitor& monitor) {
  draw_charts(route_charts(map, panels, monitor), panels.size(), "map", folder);
}

std::vector<std::pair<double, double>> curve_points(const Curve& curve, size_t most) {
  std::vector<std::pair<double, double>> points;
  for (const CurvePoint& point : thinned(curve, most))
    points.emplace_back(curve.recall(point), Curve::precision(point));
  return points;
}

std::vector<ChartRun> fix_runs(const std::vector<FrameVerdict>& verdicts) {
  std::vector<ChartRun> runs;
  for (size_t begin = 0; begin < verdicts.size();) {
    size_t end = begin;
    while (end < verdicts.size() && verdicts[end] == verdicts[begin]) ++end;
    if (verdicts[begin] != FrameVerdict::none)
      runs.push_back(
          {static_cast<double>(begin), static_cast<double>(end), meaning_of(verdicts[begin])});
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
  std::vector<std::pair<Meaning, const Curve*>> curves = best_match_curves(judgment);
  if (judgment.all_pairs)
    curves.insert(curves.begin(), {Meaning::all_pairs, &judgment.all_pairs->curve});
  for (const auto& [meaning, curve] : curves) {
    chart.series.push_back(series_of(meaning, SeriesStyle::line));
    chart.series.back().points = curve_points(*curve, kMostPoints);
  }
  erase_empty_series(chart);
  return chart;
}

Chart risk_chart(const Report& report, const Judgment& judgment) {
  Chart chart{"risk-coverage", evaluation_title(report), {"coverage: best matches accepted"}};
  chart.y.label = "risk: share of mistakes among them";
  chart.x.range = chart.y.range = {0, 1};
  for (const auto& [meaning, curve] : best_match_curves(judgment)) {
    if (curve->to_find == 0) continue;
    chart.series.push_back(series_of(meaning, SeriesStyle::line));
    chart.series.back().points = risk_coverage_points(*curve);
  }
  return chart;
}

Chart margin_chart(const Report& report, const Judgment& judgment) {
  Chart chart{"margins", evaluation_title(report)};
  chart.x = frame_axis({{"", 0, 0, 0, judgment.verdicts.size()}}, "query frame", false);
  chart.y.label = "margin, a frame";
  add_best_matches(chart, judgment, SeriesMark::dot,
                   [](const QueryOutcome& query) { return query.margin; });
  Series required = series_of(Meaning::required_margin, SeriesStyle::line);
  for (const QueryOutcome& query : judgment.outcomes.queries)
    if (query.margin && query.required_margin)
      required.points.emplace_back(static_cast<double>(query.frame) + 0.5, *query.required_margin);
  chart.series.push_back(required);
  erase_empty_series(chart);
  chart.width = 1000;
  return chart;
}

Chart timeline_chart(const Report& report, const Judgment& judgment, const GroundTruth& truth,
                     const Monitor& monitor) {
  const std::vector<FrameBand> bands = frame_bands(judgment.layout);
  Chart chart{"timeline", evaluation_title(report)};
  chart.x = frame_axis({{"", 0, 0, 0, judgment.verdicts.size()}}, "query frame", false);
  chart.y = frame_axis(bands, reference_word(report), false);
  chart.series.push_back(truth_series(judgment, truth, bands, monitor));
  add_best_matches(chart, judgment, SeriesMark::disc,
                   [&](const QueryOutcome& query) -> std::optional<double> {
                     if (!query.best) return std::nullopt;
                     return static_cast<double>(position_of(bands, *query.best)) + 0.5;
                   });
  erase_empty_series(chart);
  chart.runs = fix_runs(judgment.verdicts);
  chart.runs_label = "recognized";
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
  const PixelGrid grid(judgment.layout, most_pixels);
  const std::vector<double> scores =
      evaluation.matrix ? pixel_scores(*evaluation.matrix, grid, monitor) : std::vector<double>{};
  return matrix_chart(judgment, evaluation.truth, grid, scores,
                      {reference_word(report), score_words(report)}, monitor);
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
