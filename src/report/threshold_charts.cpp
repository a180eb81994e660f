// What each threshold accepts.
#include <array>
#include <cmath>

#include "base/json.h"
#include "matching/score_kernels.h"
#include "report/evaluation_charts.h"
#include "report/evaluation_report.h"

namespace vpr {
namespace {

constexpr size_t kMostPoints = 1000;

/// How a chart shows scores: divided, and called so.
struct ScoreAxis {
  std::string label;
  double divisor = 1;
};

/// Scores as thresholds are given: t_r as a mean frame distance or as mean z, t_p, or as they are.
ScoreAxis score_axis(const Json& report, const Judgement& judgement) {
  if (judgement.outcomes.confidence == Confidence::margin) return {"the margin per frame", 1};
  const auto length = static_cast<double>(judgement.layout.window_length);
  if (!report.contains("counts")) return {score_words(report), 1};
  if (report["settings"].contains("t_p")) return {"the probability t_p", 1};
  if (report["settings"].contains("score")) return {"the mean z (t_r)", length * kScoreUnit};
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

std::vector<RankedMatch> strictest_first(const Judgement& judgement) {
  const Outcomes& outcomes = judgement.outcomes;
  const ScoreOrder kind = confidence_order(outcomes);
  std::vector<RankedMatch> order;
  for (const QueryOutcome& query : outcomes.queries) {
    const double value = score_of_key(confidence_key(query, judgement.outcomes.confidence), kind);
    if (query.best && std::isfinite(value)) order.push_back({value, &query});
  }
  std::stable_sort(order.begin(), order.end(), [&](const RankedMatch& a, const RankedMatch& b) {
    return is_better(a.value, b.value, kind);
  });
  return order;
}

}  // namespace

Chart threshold_chart(const Json& report, const Judgement& judgement) {
  const ScoreAxis axis = score_axis(report, judgement);
  const bool is_distance = confidence_order(judgement.outcomes) == ScoreOrder::distance;
  Chart chart{"thresholds",
              evaluation_title(report),
              {is_distance ? "up to " + axis.label : axis.label + ", or more"}};
  chart.y.label = "best matches accepted";
  for (const Meaning meaning : kAccepted)
    chart.series.push_back(series_of(meaning, SeriesStyle::line));
  const std::vector<RankedMatch> order = strictest_first(judgement);
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

std::vector<ThresholdStep> threshold_steps(const Json& report, const Judgement& judgement,
                                           size_t most) {
  const ScoreAxis axis = score_axis(report, judgement);
  std::vector<ThresholdStep> steps;
  ThresholdStep step;
  for (const RankedMatch& match : strictest_first(judgement)) {
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

}  // namespace vpr
