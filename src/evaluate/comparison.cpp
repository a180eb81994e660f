#include "evaluate/comparison.h"

#include <algorithm>
#include <cassert>
#include <map>

#include <fmt/format.h>

#include "base/error.h"
#include "base/random.h"

namespace vpr {
namespace {

/// The common queries of a method; all its judged queries if it is not paired.
struct MethodQueries {
  const NamedOutcomes* method = nullptr;
  std::vector<const QueryOutcome*> queries;  // by frame
  std::vector<size_t> order;                 // most confident first, those without a score last

  uint64_t key(size_t query) const {
    return confidence_key(*queries[query], method->outcomes.confidence);
  }
};

std::vector<MethodQueries> find_common(std::span<const NamedOutcomes> methods,
                                       Comparison& comparison, Disputed disputed) {
  std::vector<MethodQueries> all(methods.size());
  std::vector<size_t> paired;                                   // indices of methods
  std::map<size_t, std::vector<const QueryOutcome*>> by_frame;  // of paired methods
  for (size_t m = 0; m < methods.size(); ++m) {
    all[m].method = &methods[m];
    for (const QueryOutcome& query : methods[m].outcomes.queries)
      if (is_judged(query) && !query.is_unreachable) all[m].queries.push_back(&query);
    comparison.own.push_back(all[m].queries.size());
    if (!methods[m].is_paired) continue;
    paired.push_back(m);
    for (const QueryOutcome* query : all[m].queries) by_frame[query->frame].push_back(query);
    all[m].queries.clear();
  }
  for (const auto& [frame, outcomes] : by_frame) {
    if (outcomes.size() < paired.size()) continue;
    const auto dispute =
        std::ranges::find(outcomes, !outcomes.front()->has_match, &QueryOutcome::has_match);
    if (dispute == outcomes.end()) {
      for (size_t i = 0; i < paired.size(); ++i) all[paired[i]].queries.push_back(outcomes[i]);
      continue;
    }
    if (disputed == Disputed::refuse)
      throw Error(ErrorKind::data,
                  fmt::format("{} and {} have different ground truths: only one has a match for "
                              "query frame {}",
                              methods.front().name,
                              methods[paired[static_cast<size_t>(dispute - outcomes.begin())]].name,
                              frame));
    ++comparison.disputed;
  }
  for (MethodQueries& method : all) {
    for (size_t q = 0; q < method.queries.size(); ++q) method.order.push_back(q);
    std::ranges::stable_sort(method.order, {}, [&](size_t q) { return method.key(q); });
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
  if (queries == 0) return std::nullopt;
  return sum / static_cast<double>(queries);
}

Curve weighted_curve(const MethodQueries& method, std::span<const uint32_t> weights) {
  std::vector<ScoredItem> items;
  uint64_t to_find = 0;
  for (const size_t q : method.order) {
    const QueryOutcome& query = *method.queries[q];
    items.push_back({method.key(q), query.verdict == Verdict::correct, weights[q]});
    if (query.has_match) to_find += weights[q];
  }
  return curve_of(items, to_find, confidence_order(method.method->outcomes));
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
                      const std::vector<MetricAt>& metrics, size_t resamples, uint64_t seed,
                      const Monitor& monitor) {
  Differences differences(paired.size(), std::vector<std::vector<double>>(metrics.size()));
  RandomEngine engine(seed);
  StepCounter counter(monitor, "resampling", resamples);
  for (size_t r = 0; r < resamples; ++r) {
    const auto weights = block_weights(comparison.common, comparison.block, engine);
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

Comparison compare_outcomes(std::span<const NamedOutcomes> methods, size_t block, size_t resamples,
                            uint64_t seed, const Monitor& monitor, Disputed disputed) {
  if (methods.size() < 2) throw Error(ErrorKind::data, "a comparison needs at least two reports");
  assert(methods.front().is_paired);
  Comparison comparison;
  const std::vector<MethodQueries> paired = find_common(methods, comparison, disputed);
  comparison.common = paired.front().queries.size();
  if (comparison.common == 0)
    throw Error(ErrorKind::data, "the reports have no query frame in common");
  comparison.block = std::clamp<size_t>(block, 1, comparison.common);
  for (const QueryOutcome* query : paired.front().queries) comparison.judged += query->has_match;
  const bool has_ranks = std::ranges::any_of(
      methods, [](const NamedOutcomes& method) { return method.outcomes.has_ranks; });
  const std::vector<MetricAt> metrics = compared_metrics(has_ranks);
  const Differences differences = bootstrap(paired, comparison, metrics, resamples, seed, monitor);
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
