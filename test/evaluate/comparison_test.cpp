#include "evaluate/comparison.h"

#include <cmath>
#include <numeric>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/random.h"
#include "evaluate/intervals.h"
#include "judgments.h"
#include "support.h"

using namespace vpr;

namespace {

/// Outcomes by letter; scores increase from frame to frame unless set.
NamedOutcomes method(const std::string& letters, const std::vector<double>& scores = {}) {
  NamedOutcomes named;
  named.outcomes = test::outcomes_of(letters);
  for (QueryOutcome& query : named.outcomes.queries)
    if (query.verdict != Verdict::none)
      query.key = score_key(scores.empty() ? double(query.frame) : scores[query.frame],
                            ScoreOrder::distance);
  return named;
}

Comparison compare(const std::vector<NamedOutcomes>& methods, size_t block = 1,
                   size_t resamples = 500) {
  return compare_outcomes(methods, {block, resamples, 1}, {});
}

ComparedValue find(const Comparison& comparison, const std::string& metric, size_t method) {
  for (const ComparedValue& value : comparison.values)
    if (value.metric.key() == metric && value.method == method) return value;
  FAIL("no " << metric);
  return {};
}

}  // namespace

TEST_CASE("values and differences equal those counted by hand") {
  const Comparison found = compare({method("ccwwn"), method("cwccn")});
  CHECK(found.frames.size() == 5);
  CHECK(found.with_match == 4);
  CHECK(find(found, "recall_at_1", 0).value == 0.5);
  CHECK_FALSE(find(found, "recall_at_1", 0).difference);
  CHECK(find(found, "recall_at_1", 1).value == 0.75);
  CHECK(find(found, "recall_at_1", 1).difference == 0.25);
  // c c w w n: (1 + 1) / 4; c w c c n: (1 + 2/3 + 3/4) / 4.
  CHECK(*find(found, "average_precision", 0).value == Approx(0.5));
  CHECK(*find(found, "average_precision", 1).value == Approx((1 + 2 / 3.0 + 0.75) / 4));
}

TEST_CASE("a method equals itself, with certainty") {
  const NamedOutcomes one = method("ccwwncwcwcwcw");
  for (const ComparedValue& value : compare({one, one}).values) {
    if (value.method == 0) continue;
    CHECK(value.difference == 0);
    CHECK(value.interval->low == 0);
    CHECK(value.interval->high == 0);
  }
}

TEST_CASE("a frame without an answer is not recognized, and common frames only on demand") {
  const std::vector<NamedOutcomes> methods = {method("cccccc"), method("uucwuc"), method("ccccwi")};
  const Comparison all = compare(methods);
  CHECK(all.frames.size() == 6);
  CHECK(find(all, "recall_at_1", 0).value == 1);
  CHECK(*find(all, "recall_at_1", 1).value == Approx(2 / 6.0));
  CHECK(*find(all, "recall_at_1", 2).value == Approx(4 / 6.0));
  CHECK(*find(all, "average_precision", 1).value == Approx((1 + 2 / 3.0) / 6));
  ComparisonSettings settings;
  settings.only_common = true;
  const Comparison common = compare_outcomes(methods, settings, {});
  CHECK(common.frames == std::vector<size_t>{2, 3});
  CHECK(find(common, "recall_at_1", 0).value == 1);
  CHECK(find(common, "recall_at_1", 1).value == 0.5);
}

TEST_CASE("incomparable methods are refused") {
  const auto kind = [](const std::vector<NamedOutcomes>& methods) {
    return test::error_kind([&] { compare(methods); });
  };
  CHECK(kind({}) == ErrorKind::data);
  CHECK(kind({method("cc")}) == std::nullopt);
  CHECK(kind({method("cc"), method("ccc")}) == ErrorKind::data);
  CHECK(kind({method(""), method("")}) == ErrorKind::data);
  CHECK(kind({method("cw"), method("cn")}) == ErrorKind::data);
  CHECK(kind({method("cw"), method("cu")}) == std::nullopt);
}

TEST_CASE("frames on whose match the ground truths disagree are omitted on demand") {
  ComparisonSettings settings;
  settings.omit_disputed = true;
  const std::vector<NamedOutcomes> methods = {method("cwcc"), method("cnwc")};
  const Comparison found = compare_outcomes(methods, settings, {});
  CHECK(found.frames == std::vector<size_t>{0, 2, 3});
  CHECK(found.disputed == 1);
  CHECK(*find(found, "recall_at_1", 1).value == Approx(2 / 3.0));
}

TEST_CASE("recall@K above 1 needs ranks, and is compared if both methods have them") {
  NamedOutcomes one = method("cw");
  one.outcomes.has_ranks = true;
  one.outcomes.queries[0].rank = 1;
  one.outcomes.queries[1].rank = 4;
  CHECK(find(compare({one, one}), "recall_at_5", 1).value == 1);
  const Comparison mixed = compare({one, method("cw")});
  CHECK(find(mixed, "recall_at_5", 0).value == 1);
  CHECK_FALSE(find(mixed, "recall_at_5", 1).value);
  CHECK_FALSE(find(mixed, "recall_at_5", 1).difference);
  for (const ComparedValue& value : compare({method("cw"), method("cw")}).values)
    CHECK(value.metric.key() != "recall_at_5");
}

TEST_CASE("each method is compared by the confidence of its decision") {
  // By score the error comes first (R@100P 0), by margin last (2/3).
  NamedOutcomes one = method("wcc");
  one.outcomes.has_margins = true;
  for (size_t q = 0; q < 3; ++q) one.outcomes.queries[q].margin = double(q);
  CHECK(find(compare({one, one}), "recall_at_100_precision", 1).value == 0);
  NamedOutcomes by_margin = one;
  by_margin.outcomes.confidence = Confidence::margin;
  const Comparison found = compare({one, by_margin});
  CHECK(find(found, "recall_at_100_precision", 0).value == 0);
  CHECK(*find(found, "recall_at_100_precision", 1).value == Approx(2 / 3.0));
  by_margin.outcomes.queries[2].margin.reset();  // never accepted
  CHECK(*find(compare({one, by_margin}), "recall_at_100_precision", 1).value == Approx(1 / 3.0));
}

TEST_CASE("another query sequence is measured separately, without an interval") {
  NamedOutcomes slow = method("ccwwwwwcn");  // half the speed, and with a frame without a match
  slow.is_paired = false;
  const Comparison found = compare({method("cwwc"), slow, method("cccw")});
  CHECK(found.frames.size() == 4);
  CHECK(find(found, "recall_at_1", 0).value == 0.5);
  CHECK(find(found, "recall_at_1", 1).value == Approx(3 / 8.0));
  CHECK(*find(found, "recall_at_1", 1).difference == Approx(-1 / 8.0));
  CHECK_FALSE(find(found, "recall_at_1", 1).interval);
  CHECK(find(found, "recall_at_1", 2).interval);
}

TEST_CASE("intervals equal the closed form for independent queries") {
  // The methods differ in a fifth of 500 queries, always in favor of one: the mean of n draws of 0
  // or 1 with p = 0.2 is normal, +- 1.96 sqrt(p (1 - p) / n).
  std::string first(500, 'w');
  std::string second(500, 'w');
  for (size_t i = 0; i < 500; i += 5) second[i] = 'c';
  const ComparedValue found =
      find(compare({method(first), method(second)}, 1, 2000), "recall_at_1", 1);
  const double half = 1.96 * std::sqrt(0.2 * 0.8 / 500);
  CHECK(found.interval->low == Approx(0.2 - half).margin(0.006));
  CHECK(found.interval->high == Approx(0.2 + half).margin(0.006));
}

TEST_CASE("a method has an interval of its own, as in closed form for independent queries") {
  std::string letters(500, 'w');
  for (size_t i = 0; i < 500; i += 5) letters[i] = 'c';
  const ComparedValue found = find(compare({method(letters)}, 1, 2000), "recall_at_1", 0);
  const double half = 1.96 * std::sqrt(0.2 * 0.8 / 500);
  CHECK(found.own->low == Approx(0.2 - half).margin(0.006));
  CHECK(found.own->high == Approx(0.2 + half).margin(0.006));
  CHECK_FALSE(found.is_best);  // there is no other
}

TEST_CASE("the best method is better than every other one beyond doubt") {
  std::string best(200, 'c');
  std::string close = best;
  std::string worse = best;
  close[7] = 'w';
  for (size_t i = 0; i < 200; i += 4) worse[i] = 'w';
  const auto is_best = [&](const std::vector<NamedOutcomes>& methods, size_t at) {
    return find(compare(methods), "recall_at_1", at).is_best;
  };
  CHECK(is_best({method(worse), method(best)}, 1));
  CHECK_FALSE(is_best({method(worse), method(best)}, 0));
  for (const size_t at : {0, 1, 2})
    CHECK_FALSE(is_best({method(worse), method(best), method(close)}, at));
  CHECK_FALSE(is_best({method(best), method(best)}, 0));
}

namespace {

// Politis and White 2004 with the correction of 2009, for the circular bootstrap, step by step.
double own_block_length(const std::vector<double>& x) {
  const size_t n = x.size();
  const double mean = std::accumulate(x.begin(), x.end(), 0.0) / double(n);
  std::vector<double> r(n);  // autocovariances
  for (size_t k = 0; k < n; ++k)
    for (size_t t = 0; t + k < n; ++t) r[k] += (x[t] - mean) * (x[t + k] - mean) / double(n);
  const double bound = 2 * std::sqrt(std::log10(double(n)) / double(n));
  const size_t few = std::max<size_t>(5, size_t(std::ceil(std::sqrt(std::log10(double(n))))));
  const size_t limit = size_t(std::ceil(std::sqrt(double(n)))) + few;
  size_t m = 0;  // lags m + 1 to m + few are not significant
  while (m < limit - few) {
    size_t last = m;
    for (size_t k = m + 1; k <= m + few; ++k)
      if (std::abs(r[k] / r[0]) > bound) last = k;
    if (last == m) break;
    m = last;
  }
  const size_t band = std::min(2 * std::max<size_t>(1, m), limit);
  double g = 0;
  double s = 0;
  for (int k = -int(band); k <= int(band); ++k) {
    const double at = std::abs(k) / double(band);
    const double lambda = at <= 0.5 ? 1 : 2 * (1 - at);
    g += lambda * std::abs(k) * r[size_t(std::abs(k))];
    s += lambda * r[size_t(std::abs(k))];
  }
  const double b = std::pow(2 * g * g / (4.0 / 3 * s * s), 1.0 / 3) * std::pow(double(n), 1.0 / 3);
  return std::clamp(b, 1.0, std::ceil(std::min(3 * std::sqrt(double(n)), double(n) / 3)));
}

}  // namespace

TEST_CASE("blocks are as long as the autocorrelation demands") {
  RandomEngine random = named_engine(3, "blocks");
  for (const uint64_t stay : {1, 4, 15, 40}) {  // mean length of runs of correct best matches
    std::vector<double> series;
    double value = 0;
    while (series.size() < 600) {
      if (uniform_below(random, stay) == 0) value = double(uniform_below(random, 2));
      series.push_back(value);
    }
    INFO(stay);
    CHECK(block_length(series) == Approx(own_block_length(series)).epsilon(1e-9));
    CHECK((stay == 1 ? block_length(series) < 6 : block_length(series) > double(stay) / 2));
  }
  CHECK(block_length(std::vector<double>(100, 1.0)) == 1);
  CHECK(block_length(std::vector<double>{0, 1}) == 1);
  // A comparison takes the longest one.
  std::string runs;
  for (int i = 0; i < 400; ++i) runs += i / 40 % 2 == 0 ? 'c' : 'w';
  std::vector<double> correct;
  for (const char letter : runs) correct.push_back(letter == 'c' ? 1 : 0);
  const auto expected = size_t(std::ceil(block_length(correct)));
  CHECK(expected > 10);
  CHECK(compare({method(runs), method(std::string(400, 'c'))}, 0).block == expected);
}

TEST_CASE("pairing makes the interval of a difference narrower than its parts") {
  // Both methods fail in the same parts; one fails slightly more often.
  std::string first;
  for (int i = 0; i < 400; ++i) first += i / 40 % 2 == 0 ? 'c' : 'w';
  std::string second = first;
  for (size_t i = 0; i < 400; i += 80) second[i] = 'w';
  const Comparison found = compare({method(first), method(second)}, 20, 1000);
  const ComparedValue value = find(found, "recall_at_1", 1);
  CHECK(*value.difference == Approx(-5.0 / 400));
  CHECK(value.interval->high - value.interval->low < 0.05);
  CHECK(compare({method(first), method(second)}, 20, 1000).values[1].interval->low ==
        value.interval->low);
}
