#include "evaluate/comparison.h"

#include <algorithm>
#include <cassert>

#include "base/error.h"
#include "base/random.h"

namespace vpr {
namespace {

/// The compared frames of a method; all of its own if it is not paired.
struct MethodQueries {
  const NamedOutcomes* method = nullptr;
  std::vector<const QueryOutcome*> queries;  // by frame
  std::vector<size_t> order;                 // most confident first, those without a score last

  uint64_t key(size_t query) const {
    return confidence_key(*queries[query], method->outcomes.confidence);
  }
};

bool is_answered(const QueryOutcome& query) {
  return query.verdict == Verdict::correct || query.verdict == Verdict::incorrect;
}

// Whether the frame is compared. Throws Error(data) if the ground truths disagree.
bool is_compared(const std::vector<const NamedOutcomes*>& paired, size_t frame,
                 const ComparisonSettings& settings, Comparison& comparison) {
  const auto at = [&](const NamedOutcomes* method) -> const QueryOutcome& {
    return method->outcomes.queries[frame];
  };
  if (settings.only_common &&
      !std::ranges::all_of(paired, [&](const auto* method) { return is_answered(at(method)); }))
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

std::vector<MethodQueries> find_compared(std::span<const NamedOutcomes> methods,
                                         const ComparisonSettings& settings,
                                         Comparison& comparison) {
  std::vector<const NamedOutcomes*> paired;
  for (const NamedOutcomes& method : methods) {
    comparison.own.push_back(method.outcomes.queries.size());
    if (method.is_paired) paired.push_back(&method);
  }
  const size_t frames = paired.front()->outcomes.queries.size();
  for (const NamedOutcomes* method : paired)
    if (method->outcomes.queries.size() != frames)
      throw Error(ErrorKind::data, "{} has {} query frames, and {} has {}", paired.front()->name,
                  frames, method->name, method->outcomes.queries.size());
  for (size_t frame = 0; frame < frames; ++frame)
    if (is_compared(paired, frame, settings, comparison)) comparison.frames.push_back(frame);
  std::vector<MethodQueries> all;
  for (const NamedOutcomes& method : methods) {
    MethodQueries& one = all.emplace_back(MethodQueries{&method, {}, {}});
    const std::vector<QueryOutcome>& queries = method.outcomes.queries;
    if (method.is_paired)
      for (const size_t frame : comparison.frames) one.queries.push_back(&queries[frame]);
    else
      for (const QueryOutcome& query : queries) one.queries.push_back(&query);
    for (size_t q = 0; q < one.queries.size(); ++q)
      if (is_answered(*one.queries[q])) one.order.push_back(q);
    std::ranges::stable_sort(one.order, {}, [&](size_t q) { return one.key(q); });
  }
  return all;
}

std::optional<double> weighted_mean(const MethodQueries& method, std::span<const uint32_t> weights,
                                    const MetricAt& metric) {
  if (!metric.metric->is_known_at(method.method->outcomes, metric.k)) return std::nullopt;
  uint64_t queries = 0;
  double sum = 0;
  for (size_t q = 0; q < weights.size(); ++q) {
    const QueryOutcome& query = *method.queries[q];
    if (!query.has_match) continue;
    queries += weights[q];
    sum += weights[q] * metric.metric->of_query(query, metric.k);
  }
  return share_of(sum, queries);
}

Curve weighted_curve(const MethodQueries& method, std::span<const uint32_t> weights) {
  std::vector<ScoredItem> items;
  for (const size_t q : method.order)
    items.push_back({method.key(q), method.queries[q]->verdict == Verdict::correct, weights[q]});
  uint64_t positives = 0;
  for (size_t q = 0; q < weights.size(); ++q)
    if (method.queries[q]->has_match) positives += weights[q];
  const Outcomes& outcomes = method.method->outcomes;
  Curve curve = curve_of(items, positives, confidence_order(outcomes));
  curve.has_scores = outcomes.has_scores;
  if (!curve.has_scores) curve.points.clear();
  return curve;
}

std::vector<std::optional<double>> metric_values(const MethodQueries& method,
                                                 std::span<const uint32_t> weights,
                                                 const std::vector<MetricAt>& compared) {
  const Curve curve = weighted_curve(method, weights);
  std::vector<std::optional<double>> values;
  for (const MetricAt& metric : compared)
    values.push_back(metric.metric->of_curve != nullptr ? metric.metric->of_curve(curve).value
                                                        : weighted_mean(method, weights, metric));
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

PairedCounts count_pairs(const MethodQueries& first, const MethodQueries& method) {
  PairedCounts counts;
  if (!method.method->is_paired) return counts;
  for (size_t q = 0; q < method.queries.size(); ++q) {
    if (!method.queries[q]->has_match) continue;
    const bool here = method.queries[q]->verdict == Verdict::correct;
    const bool there = first.queries[q]->verdict == Verdict::correct;
    ++(here && there ? counts.both_correct
       : here        ? counts.only_this
       : there       ? counts.only_first
                     : counts.neither);
  }
  return counts;
}

/// Differences from the first method, by method, metric and resample.
using Differences = std::vector<std::vector<std::vector<double>>>;

Differences bootstrap(const std::vector<MethodQueries>& paired, const Comparison& comparison,
                      const std::vector<MetricAt>& metrics, const ComparisonSettings& settings,
                      const Monitor& monitor) {
  Differences differences(paired.size(), std::vector<std::vector<double>>(metrics.size()));
  RandomEngine engine(settings.seed);
  StepCounter counter(monitor, "resampling", settings.resamples);
  for (size_t r = 0; r < settings.resamples; ++r) {
    const auto weights = block_weights(comparison.frames.size(), comparison.block, engine);
    const auto first = metric_values(paired.front(), weights, metrics);
    for (size_t m = 1; m < paired.size(); ++m) {
      if (!paired[m].method->is_paired) continue;
      const auto values = metric_values(paired[m], weights, metrics);
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
  const std::vector<MethodQueries> paired = find_compared(methods, settings, comparison);
  if (comparison.frames.empty())
    throw Error(ErrorKind::data, "the reports have no query frame in common");
  comparison.block = std::clamp<size_t>(settings.block, 1, comparison.frames.size());
  for (const QueryOutcome* query : paired.front().queries)
    comparison.with_match += query->has_match;
  const bool has_ranks = std::ranges::any_of(
      methods, [](const NamedOutcomes& method) { return method.outcomes.has_ranks; });
  const std::vector<MetricAt> metrics = compared_metrics(has_ranks);
  const Differences differences = bootstrap(paired, comparison, metrics, settings, monitor);
  std::vector<std::vector<std::optional<double>>> values;
  for (const MethodQueries& method : paired) {
    const std::vector<uint32_t> once(method.queries.size(), 1);
    values.push_back(metric_values(method, once, metrics));
    comparison.paired.push_back(count_pairs(paired.front(), method));
  }
  for (size_t i = 0; i < metrics.size(); ++i) {
    for (size_t m = 0; m < paired.size(); ++m) {
      ComparedValue& compared =
          comparison.values.emplace_back(ComparedValue{metrics[i], m, {}, {}, {}});
      compared.value = values[m][i];
      if (m == 0 || !values[m][i] || !values[0][i]) continue;
      compared.difference = *values[m][i] - *values[0][i];
      const auto& resampled = differences[m][i];
      if (!resampled.empty())
        compared.interval = Interval{quantile(resampled, 0.025), quantile(resampled, 0.975)};
    }
  }
  return comparison;
}

}  // namespace vpr
