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

std::optional<double> weighted_recall(const MethodQueries& method,
                                      std::span<const uint32_t> weights, size_t k) {
  if (k > 1 && !method.method->outcomes.has_ranks) return std::nullopt;
  uint64_t to_find = 0;
  uint64_t found = 0;
  for (size_t q = 0; q < weights.size(); ++q) {
    const QueryOutcome& query = *method.queries[q];
    if (!query.has_match) continue;
    to_find += weights[q];
    if (is_found_at(query, k)) found += weights[q];
  }
  if (to_find == 0) return std::nullopt;
  return static_cast<double>(found) / static_cast<double>(to_find);
}

std::vector<std::optional<double>> metric_values(const MethodQueries& method,
                                                 std::span<const uint32_t> weights,
                                                 const std::vector<size_t>& ks) {
  std::vector<std::optional<double>> values;
  for (const size_t k : ks) values.push_back(weighted_recall(method, weights, k));
  std::vector<ScoredItem> items;
  uint64_t to_find = 0;
  for (const size_t q : method.order) {
    const QueryOutcome& query = *method.queries[q];
    items.push_back({method.key(q), query.verdict == Verdict::correct, weights[q]});
    if (query.has_match) to_find += weights[q];
  }
  const Curve curve = curve_of(items, to_find, confidence_order(method.method->outcomes));
  for (const Metric& metric : curve_metrics()) values.push_back(metric.of_curve(curve).value);
  return values;
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
                      const std::vector<size_t>& ks, size_t resamples, uint64_t seed,
                      const Monitor& monitor) {
  const size_t metrics = ks.size() + curve_metrics().size();
  Differences differences(paired.size(), std::vector<std::vector<double>>(metrics));
  RandomEngine engine(seed);
  StepCounter counter(monitor, "resampling", resamples);
  for (size_t r = 0; r < resamples; ++r) {
    const auto weights = block_weights(comparison.common, comparison.block, engine);
    const auto first = metric_values(paired.front(), weights, ks);
    for (size_t m = 1; m < paired.size(); ++m) {
      if (!paired[m].method->is_paired) continue;
      const auto values = metric_values(paired[m], weights, ks);
      for (size_t i = 0; i < metrics; ++i)
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
  std::vector<size_t> ks;
  for (const size_t k : kRecallAt)
    if (k == 1 || has_ranks) ks.push_back(k);
  const Differences differences = bootstrap(paired, comparison, ks, resamples, seed, monitor);
  std::vector<std::vector<std::optional<double>>> values;
  for (const MethodQueries& method : paired) {
    const std::vector<uint32_t> once(method.queries.size(), 1);
    values.push_back(metric_values(method, once, ks));
    comparison.paired.push_back(count_pairs(paired.front(), method));
  }
  for (size_t i = 0; i < ks.size() + curve_metrics().size(); ++i) {
    const bool is_recall = i < ks.size();
    const Metric& metric = is_recall ? find_metric("recall_at") : curve_metrics()[i - ks.size()];
    const std::string key =
        is_recall ? fmt::format("{}_{}", metric.key, ks[i]) : std::string(metric.key);
    for (size_t m = 0; m < paired.size(); ++m) {
      ComparedValue& compared =
          comparison.values.emplace_back(ComparedValue{key, &metric, m, {}, {}, {}});
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
