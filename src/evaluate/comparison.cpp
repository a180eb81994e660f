#include "evaluate/comparison.h"

#include <algorithm>
#include <cassert>
#include <map>

#include <fmt/format.h>

#include "base/error.h"
#include "base/random.h"
#include "evaluate/metrics.h"
#include "evaluate/outcomes.h"

namespace vpr {
namespace {

/// One method's common queries, ready to be counted with weights.
struct Paired {
  std::vector<const QueryOutcome*> queries;  // by frame
  std::vector<size_t> order;                 // most confident first, those without a score last
  const Outcomes* outcomes = nullptr;
  bool is_paired = true;
};

// A query that one method could not get right is no measure of the others.
bool is_comparable(const QueryOutcome& query) {
  return !query.is_unreachable &&
         (query.verdict == Verdict::correct || query.verdict == Verdict::incorrect);
}

std::map<size_t, const QueryOutcome*> judged_by_frame(const Outcomes& outcomes) {
  std::map<size_t, const QueryOutcome*> frames;
  for (const QueryOutcome& query : outcomes.queries)
    if (is_comparable(query)) frames[query.frame] = &query;
  return frames;
}

// The outcomes of one query frame, one a method; none where a method does not judge it.
using FrameOutcomes = std::vector<const QueryOutcome*>;

FrameOutcomes outcomes_at(const std::vector<std::map<size_t, const QueryOutcome*>>& frames,
                          size_t frame) {
  FrameOutcomes outcomes;
  for (const auto& own : frames) {
    const auto found = own.find(frame);
    if (found == own.end()) return {};
    outcomes.push_back(found->second);
  }
  return outcomes;
}

uint64_t key_of(const Paired& method, size_t query) {
  return confidence_key(*method.queries[query], method.outcomes->confidence);
}

void sort_by_confidence(Paired& method) {
  for (size_t q = 0; q < method.queries.size(); ++q) method.order.push_back(q);
  std::stable_sort(method.order.begin(), method.order.end(),
                   [&](size_t a, size_t b) { return key_of(method, a) < key_of(method, b); });
}

std::vector<Paired> pair_up(std::span<const NamedOutcomes> methods, Comparison& comparison,
                            Disputed disputed) {
  std::vector<size_t> partners;  // methods whose frames have partners
  std::vector<Paired> paired(methods.size());
  std::vector<std::map<size_t, const QueryOutcome*>> frames;  // of partners
  for (size_t m = 0; m < methods.size(); ++m) {
    const Outcomes& outcomes = methods[m].outcomes;
    paired[m] = {{}, {}, &outcomes, methods[m].is_paired};
    auto judged = judged_by_frame(outcomes);
    comparison.own.push_back(judged.size());
    if (methods[m].is_paired) {
      partners.push_back(m);
      frames.push_back(std::move(judged));
    } else {
      for (const auto& entry : judged) paired[m].queries.push_back(entry.second);
    }
  }
  for (const auto& entry : frames.front()) {
    const FrameOutcomes outcomes = outcomes_at(frames, entry.first);
    const auto dispute = std::ranges::find_if(outcomes, [&](const QueryOutcome* outcome) {
      return outcome->has_match != outcomes.front()->has_match;
    });
    if (dispute != outcomes.end()) {
      if (disputed == Disputed::refuse)
        throw Error(
            ErrorKind::data,
            fmt::format("{} and {} have different ground truths: only one has a match for "
                        "query frame {}",
                        methods.front().name,
                        methods[partners[static_cast<size_t>(dispute - outcomes.begin())]].name,
                        entry.first));
      ++comparison.disputed;
      continue;
    }
    for (size_t i = 0; i < outcomes.size(); ++i) paired[partners[i]].queries.push_back(outcomes[i]);
  }
  for (Paired& method : paired) sort_by_confidence(method);
  return paired;
}

std::optional<double> weighted_recall(const Paired& method, std::span<const uint32_t> weights,
                                      size_t k) {
  if (k > 1 && !method.outcomes->has_ranks) return std::nullopt;
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

std::vector<std::optional<double>> metric_values(const Paired& method,
                                                 std::span<const uint32_t> weights,
                                                 const std::vector<size_t>& ks) {
  std::vector<std::optional<double>> values;
  for (const size_t k : ks) values.push_back(weighted_recall(method, weights, k));
  std::vector<ScoredItem> items;
  uint64_t to_find = 0;
  for (const size_t q : method.order) {
    const QueryOutcome& query = *method.queries[q];
    items.push_back({key_of(method, q), query.verdict == Verdict::correct, weights[q]});
    if (query.has_match) to_find += weights[q];
  }
  const Curve curve = curve_of(items, to_find, confidence_order(*method.outcomes));
  for (const Metric& metric : curve_metrics()) values.push_back(metric.of_curve(curve).value);
  return values;
}

PairedCounts count_pairs(const Paired& first, const Paired& method) {
  PairedCounts counts;
  if (!method.is_paired) return counts;
  for (size_t q = 0; q < method.queries.size(); ++q) {
    if (!method.queries[q]->has_match) continue;
    const bool here = method.queries[q]->verdict == Verdict::correct;
    const bool there = first.queries[q]->verdict == Verdict::correct;
    ++(here && there ? counts.both_right
       : here        ? counts.only_this
       : there       ? counts.only_first
                     : counts.neither);
  }
  return counts;
}

/// Differences to the first method, per method and metric, resample after resample.
using Differences = std::vector<std::vector<std::vector<double>>>;

Differences bootstrap(const std::vector<Paired>& paired, const Comparison& comparison,
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
      if (!paired[m].is_paired) continue;
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
  if (methods.size() < 2) throw Error(ErrorKind::data, "a comparison needs two or more reports");
  assert(methods.front().is_paired);
  Comparison comparison;
  const std::vector<Paired> paired = pair_up(methods, comparison, disputed);
  comparison.common = paired.front().queries.size();
  if (comparison.common == 0)
    throw Error(ErrorKind::data, "the reports have no query frame in common");
  comparison.block = std::clamp<size_t>(block, 1, comparison.common);
  for (const QueryOutcome* query : paired.front().queries) comparison.judged += query->has_match;
  const bool has_ranks = std::any_of(methods.begin(), methods.end(),
                                     [](const NamedOutcomes& m) { return m.outcomes.has_ranks; });
  std::vector<size_t> ks;
  for (const size_t k : kRecallAt)
    if (k == 1 || has_ranks) ks.push_back(k);
  const Differences differences = bootstrap(paired, comparison, ks, resamples, seed, monitor);
  std::vector<std::vector<std::optional<double>>> values;
  for (const Paired& method : paired) {
    const std::vector<uint32_t> once(method.queries.size(), 1);
    values.push_back(metric_values(method, once, ks));
    comparison.paired.push_back(count_pairs(paired.front(), method));
  }
  // recall@K, then the metrics of the curve
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
