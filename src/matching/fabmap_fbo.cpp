#include "matching/fabmap_fbo.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace vpr {
namespace {

const double kLogProbability = std::log(1e-6);

constexpr size_t kStepsBetween = 32;  // words between two times that views are dropped

/// A word in the order of evaluation, and what may still come from it and later ones on.
struct Step {
  uint32_t word = 0;
  double p_observed = 0;  // P(z_q | z_parent) of what was observed: small speaks loudest
  double without = 0;     // log-likelihood of a view that does not show the word
  double with = 0;
  double gap = 0;  // a view further behind the best before this step is dropped; 0: none is
};

std::vector<Step> plan_steps(const FabmapQuery& query) {
  const FabmapModel& model = query.model;
  const std::vector<uint8_t> seen = word_flags(query.words, model.words());
  std::vector<Step> steps;
  for (uint32_t q = 0; q < model.words(); ++q) {
    const bool z = seen[q] != 0;
    const bool parent = seen[model.parent[q]] != 0;
    const double given = parent ? model.p_given[q] : model.p_given_not[q];
    const size_t row = 4 * size_t{z} + 2 * size_t{parent};
    steps.push_back({q, z ? given : 1 - given, model.log_p[q][row], model.log_p[q][row + 1], 0});
  }
  std::stable_sort(steps.begin(), steps.end(),
                   [](const Step& a, const Step& b) { return a.p_observed < b.p_observed; });
  double variance = 0;
  double largest = 0;
  for (size_t s = steps.size(); s-- > 0;) {
    Step& step = steps[s];
    const double difference = step.with - step.without;
    const double p = model.p[step.word];
    // Two views differ by the difference, one way or the other, where just one shows the word.
    variance += 2 * p * (1 - p) * difference * difference;
    largest = std::max(largest, std::abs(difference));
    if (s % kStepsBetween == 0) step.gap = bail_out_gap(variance, largest);
  }
  return steps;
}

std::vector<uint32_t> readable_views(const FabmapQuery& query) {
  std::vector<uint8_t> is_readable(query.known_views, 1);
  for (const size_t view : query.unreadable)
    if (view < query.known_views) is_readable[view] = 0;
  std::vector<uint32_t> views;
  for (uint32_t v = 0; v < query.known_views; ++v)
    if (is_readable[v] != 0) views.push_back(v);
  return views;
}

double best_of(const std::vector<uint32_t>& views, const std::vector<double>& sums) {
  double best = -std::numeric_limits<double>::infinity();
  for (const uint32_t v : views) best = std::max(best, sums[v]);
  return best;
}

}  // namespace

double bail_out_gap(double variance, double largest) {
  if (variance <= 0 || largest <= 0) return -kLogProbability;
  const auto log_bound = [&](double gap) {
    const double x = gap * largest / variance;
    const double f = std::asinh(x);
    return variance / (largest * largest) * (std::cosh(f) - 1 - x * f);
  };
  double low = 0;
  double high = 1;
  while (log_bound(high) > kLogProbability) high *= 2;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (log_bound(middle) > kLogProbability ? low : high) = middle;
  }
  return std::max(-kLogProbability, high);
}

std::vector<double> fbo_log_likelihoods(const FabmapQuery& query) {
  const FabmapIndex& index = query.index;
  std::vector<double> sums(index.lists.views, 0);  // without what every view gets alike
  std::vector<uint32_t> alive = readable_views(query);
  double to_all = 0;
  for (const Step& step : plan_steps(query)) {
    if (step.gap > 0) {
      const double best = best_of(alive, sums);
      std::erase_if(alive, [&](uint32_t v) { return sums[v] < best - step.gap; });
    }
    to_all += step.without;
    for (size_t block = 0; block < index.lists.blocks(); ++block)
      for (const uint16_t v : index.lists.list(block, step.word))
        sums[block * kIndexBlock + v] += step.with - step.without;
  }
  const double best = best_of(alive, sums);
  std::vector<double> result(query.known_views, best + to_all + kLogProbability);
  for (const uint32_t v : alive) result[v] = sums[v] + to_all;
  return result;
}

}  // namespace vpr
