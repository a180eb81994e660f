#include "evaluate/comparison.h"

#include <algorithm>
#include <cassert>

#include "base/error.h"
#include "base/random.h"

namespace vpr {
namespace {

// Whether the frame is compared. Throws Error(data) if the ground truths disagree.
bool is_compared(const std::vector<const NamedOutcomes*>& paired, size_t frame,
                 const ComparisonSettings& settings, Comparison& comparison) {
  const auto at = [&](const NamedOutcomes* method) -> const QueryOutcome& {
    return method->outcomes.queries[frame];
  };
  if (settings.only_common &&
      !std::ranges::all_of(paired, [&](const auto* method) { return is_judged(at(method)); }))
    return false;
  const bool has_match = at(paired.front()).has_match;
  const auto other = std::ranges::find_if(
      paired, [&](const auto* method) { return at(method).has_match != has_match; });
  if (other == paired.end()) return true;
  if (!settings.omit_disputed)
    throw Error(ErrorKind::data,
                "{} and {} have different ground truths: only one has a match for query frame {}",
                paired.front()->name, (*other)->name, frame);
  ++comparison.disputed;
  return false;
}

// The compared frames of each method, with their number as `frame`; all of its own if it is not
// paired.
std::vector<Outcomes> find_compared(std::span<const NamedOutcomes> methods,
                                    const ComparisonSettings& settings, Comparison& comparison) {
  std::vector<const NamedOutcomes*> paired;
  for (const NamedOutcomes& method : methods)
    if (method.is_paired) paired.push_back(&method);
  const size_t frames = paired.front()->outcomes.queries.size();
  for (const NamedOutcomes* method : paired)
    if (method->outcomes.queries.size() != frames)
      throw Error(ErrorKind::data, "{} has {} query frames, and {} has {}", paired.front()->name,
                  frames, method->name, method->outcomes.queries.size());
  for (size_t frame = 0; frame < frames; ++frame)
    if (is_compared(paired, frame, settings, comparison)) comparison.frames.push_back(frame);
  std::vector<Outcomes> all;
  for (const NamedOutcomes& method : methods) {
    std::vector<QueryOutcome>& queries = all.emplace_back(method.outcomes).queries;
    if (method.is_paired) {  // frames rise, so each is moved to its place or to an earlier one
      for (size_t q = 0; q < comparison.frames.size(); ++q)
        queries[q] = queries[comparison.frames[q]];
      queries.resize(comparison.frames.size());
    }
    for (size_t q = 0; q < queries.size(); ++q) queries[q].frame = q;
  }
  return all;
}

std::vector<std::optional<double>> metric_values(const Outcomes& outcomes,
                                                 std::span<const uint32_t> weights,
                                                 const std::vector<MetricAt>& compared) {
  const Curve curve = single_best_curve(outcomes, weights);
  std::vector<std::optional<double>> values;
  for (const MetricAt& metric : compared)
    values.push_back(metric.metric->of_curve != nullptr ? metric.metric->of_curve(curve).value
                                                        : rank_value(metric, outcomes, weights));
  return values;
}

// Reports have the first correct rank of a query, not all.
std::vector<MetricAt> compared_metrics(bool has_ranks) {
  std::vector<MetricAt> all;
  for (const Metric& metric : rank_metrics())
    for (const size_t k : kRecallAt)
      if (!metric.needs_all_ranks && (k == 1 || has_ranks)) all.push_back({&metric, k});
  for (const Metric& metric : curve_metrics()) all.push_back({&metric});
  return all;
}

/// Differences from the first method, by method, metric and resample.
using Differences = std::vector<std::vector<std::vector<double>>>;

Differences bootstrap(std::span<const NamedOutcomes> methods, const std::vector<Outcomes>& compared,
                      const Comparison& comparison, const std::vector<MetricAt>& metrics,
                      const ComparisonSettings& settings, const Monitor& monitor) {
  Differences differences(methods.size(), std::vector<std::vector<double>>(metrics.size()));
  RandomEngine engine(settings.seed);
  StepCounter counter(monitor, "resampling", settings.resamples);
  for (size_t r = 0; r < settings.resamples; ++r) {
    const auto weights = block_weights(comparison.frames.size(), comparison.block, engine);
    const auto first = metric_values(compared.front(), weights, metrics);
    for (size_t m = 1; m < methods.size(); ++m) {
      if (!methods[m].is_paired) continue;
      const auto values = metric_values(compared[m], weights, metrics);
      for (size_t i = 0; i < metrics.size(); ++i)
        if (values[i] && first[i]) differences[m][i].push_back(*values[i] - *first[i]);
    }
    counter.add();
  }
  return differences;
}

}  // namespace

Comparison compare_outcomes(std::span<const NamedOutcomes> methods,
                            const ComparisonSettings& settings, const Monitor& monitor) {
  if (methods.size() < 2) throw Error(ErrorKind::data, "a comparison needs at least two reports");
  assert(methods.front().is_paired);
  Comparison comparison;
  std::vector<Outcomes> compared = find_compared(methods, settings, comparison);
  if (comparison.frames.empty())
    throw Error(ErrorKind::data, "the reports have no query frame in common");
  comparison.block = std::clamp<size_t>(settings.block, 1, comparison.frames.size());
  comparison.with_match = frames_with_match(compared.front());
  for (Outcomes& method : compared)  // each resample then sorts what is sorted
    std::ranges::stable_sort(method.queries, {}, [&](const QueryOutcome& query) {
      return confidence_key(query, method.confidence);
    });
  const bool has_ranks = std::ranges::any_of(
      methods, [](const NamedOutcomes& method) { return method.outcomes.has_ranks; });
  const std::vector<MetricAt> metrics = compared_metrics(has_ranks);
  const Differences differences =
      bootstrap(methods, compared, comparison, metrics, settings, monitor);
  std::vector<std::vector<std::optional<double>>> values;
  for (const Outcomes& method : compared) values.push_back(metric_values(method, {}, metrics));
  for (size_t i = 0; i < metrics.size(); ++i)
    for (size_t m = 0; m < methods.size(); ++m) {
      ComparedValue& value =
          comparison.values.emplace_back(ComparedValue{metrics[i], m, values[m][i], {}, {}});
      if (m == 0 || !values[m][i] || !values[0][i]) continue;
      value.difference = *values[m][i] - *values[0][i];
      const auto& resampled = differences[m][i];
      if (!resampled.empty())
        value.interval = Interval{quantile(resampled, 0.025), quantile(resampled, 0.975)};
    }
  return comparison;
}

}  // namespace vpr
