#include "evaluate/comparison.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <set>

#include "base/error.h"
#include "base/random.h"
#include "evaluate/intervals.h"

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
std::vector<MetricAt> compared_metrics(const std::vector<size_t>& recall_at, bool has_ranks) {
  std::set<size_t> ks = {1};
  if (recall_at.empty())
    ks.insert(kRecallAt.begin(), kRecallAt.end());
  else
    ks.insert(recall_at.begin(), recall_at.end());
  std::vector<MetricAt> all;
  for (const Metric& metric : rank_metrics())
    for (const size_t k : ks)
      if (!metric.needs_all_ranks && (k == 1 || has_ranks)) all.push_back({&metric, k});
  for (const Metric& metric : curve_metrics()) all.push_back({&metric});
  return all;
}

// In frames of the query, in whose order the outcomes are.
size_t default_block(std::span<const NamedOutcomes> methods, const std::vector<Outcomes>& compared,
                     size_t frames) {
  double longest = 1;
  for (size_t m = 0; m < methods.size(); ++m) {
    if (!methods[m].is_paired) continue;
    std::vector<double> correct;  // of frames with a match
    for (const QueryOutcome& query : compared[m].queries)
      if (query.has_match) correct.push_back(query.verdict == Verdict::correct ? 1 : 0);
    if (correct.empty()) continue;
    const double step = static_cast<double>(frames) / static_cast<double>(correct.size());
    longest = std::max(longest, step * block_length(correct));
  }
  return static_cast<size_t>(std::ceil(longest));
}

/// Values by method, metric and resample.
using Resamples = std::vector<std::vector<std::vector<std::optional<double>>>>;

Resamples bootstrap(std::span<const NamedOutcomes> methods, const std::vector<Outcomes>& compared,
                    const Comparison& comparison, const std::vector<MetricAt>& metrics,
                    const ComparisonSettings& settings, const Monitor& monitor) {
  Resamples resampled(methods.size(),
                      std::vector<std::vector<std::optional<double>>>(metrics.size()));
  RandomEngine engine(settings.seed);
  StepCounter counter(monitor, "resampling", settings.resamples);
  for (size_t r = 0; r < settings.resamples; ++r) {
    const auto weights = block_weights(comparison.frames.size(), comparison.block, engine);
    for (size_t m = 0; m < methods.size(); ++m) {
      if (!methods[m].is_paired) continue;
      const auto values = metric_values(compared[m], weights, metrics);
      for (size_t i = 0; i < metrics.size(); ++i) resampled[m][i].push_back(values[i]);
    }
    counter.add();
  }
  return resampled;
}

// The interval of the values or, with `others`, of their differences; unset if none is known.
std::optional<Interval> interval_of(const std::vector<std::optional<double>>& values,
                                    const std::vector<std::optional<double>>* others = nullptr) {
  std::vector<double> known;
  for (size_t r = 0; r < values.size(); ++r)
    if (values[r] && (others == nullptr || (*others)[r]))
      known.push_back(*values[r] - (others == nullptr ? 0 : *(*others)[r]));
  if (known.empty()) return std::nullopt;
  return Interval{quantile(known, 0.025), quantile(known, 0.975)};
}

// Marks the method that is better than every other one.
void mark_best(std::span<ComparedValue> of_metric, const Resamples& resampled, size_t metric) {
  const bool is_low_good = of_metric.front().metric.metric->is_low_good;
  ComparedValue* best = nullptr;
  for (ComparedValue& value : of_metric)
    if (value.own && (best == nullptr ||
                      (is_low_good ? *value.value < *best->value : *value.value > *best->value)))
      best = &value;
  if (best == nullptr) return;
  size_t others = 0;
  for (const ComparedValue& other : of_metric) {
    if (&other == best || !other.own) continue;
    const auto interval =
        interval_of(resampled[best->method][metric], &resampled[other.method][metric]);
    if (!interval || (is_low_good ? interval->high >= 0 : interval->low <= 0)) return;
    ++others;
  }
  best->is_best = others > 0;
}

}  // namespace

Comparison compare_outcomes(std::span<const NamedOutcomes> methods,
                            const ComparisonSettings& settings, const Monitor& monitor) {
  if (methods.empty()) throw Error(ErrorKind::data, "a comparison needs a report");
  assert(methods.front().is_paired);
  Comparison comparison;
  std::vector<Outcomes> compared = find_compared(methods, settings, comparison);
  if (comparison.frames.empty())
    throw Error(ErrorKind::data, "the reports have no query frame in common");
  const size_t frames = comparison.frames.size();
  comparison.block = std::clamp<size_t>(
      settings.block > 0 ? settings.block : default_block(methods, compared, frames), 1, frames);
  comparison.with_match = frames_with_match(compared.front());
  for (Outcomes& method : compared)  // each resample then sorts what is sorted
    std::ranges::stable_sort(method.queries, {}, [&](const QueryOutcome& query) {
      return confidence_key(query, method.confidence);
    });
  const bool has_ranks = std::ranges::any_of(
      methods, [](const NamedOutcomes& method) { return method.outcomes.has_ranks; });
  const std::vector<MetricAt> metrics = compared_metrics(settings.recall_at, has_ranks);
  const Resamples resampled = bootstrap(methods, compared, comparison, metrics, settings, monitor);
  std::vector<std::vector<std::optional<double>>> values;
  for (const Outcomes& method : compared) values.push_back(metric_values(method, {}, metrics));
  for (size_t i = 0; i < metrics.size(); ++i) {
    for (size_t m = 0; m < methods.size(); ++m) {
      ComparedValue& value = comparison.values.emplace_back();
      value.metric = metrics[i];
      value.method = m;
      value.value = values[m][i];
      if (!values[m][i] || !methods[m].is_paired) continue;
      value.own = interval_of(resampled[m][i]);
    }
    const auto of_metric = std::span(comparison.values).last(methods.size());
    for (ComparedValue& value : of_metric) {
      const size_t m = value.method;
      if (m == 0 || !values[m][i] || !values[0][i]) continue;
      value.difference = *values[m][i] - *values[0][i];
      if (methods[m].is_paired) value.interval = interval_of(resampled[m][i], &resampled[0][i]);
    }
    mark_best(of_metric, resampled, i);
  }
  return comparison;
}

}  // namespace vpr
