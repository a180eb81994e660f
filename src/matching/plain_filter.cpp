#include "matching/plain_filter.h"

#include <algorithm>
#include <cmath>

#include "matching/score_kernels.h"

namespace vpr {
namespace {

double likelihood(const FilterSettings& settings, uint16_t score) {
  const double z = (static_cast<double>(score) - kScoreBias) / kScoreUnit;
  return std::exp(-settings.sharpness * (std::min(z, 8.0) - settings.unmatched));
}

// What comes to a cell at a rate by steps within its run, before anything is seen.
double stepped(const PlainFilter& filter, const CellRun& run, size_t rate, size_t to) {
  const FilterRate& steps = filter_rates()[rate];
  double sum = 0;
  for (size_t s = 0; s < kSteps; ++s) {
    const size_t step = kFirstSteps[rate] + s;
    if (to < run.first + step) continue;
    double all = 0;
    for (const std::vector<double>& masses : filter.rates) all += masses[to - step];
    sum += steps.steps[s] * ((1 - filter.settings.rate_change) * filter.rates[rate][to - step] +
                             filter.settings.rate_change * steps.prior * all);
  }
  return sum;
}

}  // namespace

PlainFilter start_plain_filter(const FilterCells& cells, const FilterSettings& settings) {
  PlainFilter filter{cells, settings, {}, std::vector<double>(cells.size()), 0.5};
  for (const FilterRate& rate : filter_rates()) {
    std::vector<double>& masses = filter.rates.emplace_back(cells.size());
    for (const CellRun& run : cells.runs)
      for (size_t c = run.first; c < run.first + run.count; ++c)
        masses[c] = 0.5 * rate.prior / static_cast<double>(cells.places);
  }
  return filter;
}

void advance_plain_filter(PlainFilter& filter, std::span<const uint16_t> scores) {
  const FilterSettings& settings = filter.settings;
  const double stays = (1 - settings.enter) * (1 - settings.jump);
  const double lands = ((1 - filter.nowhere) * (1 - settings.enter) * settings.jump +
                        filter.nowhere * settings.leave) /
                       static_cast<double>(filter.cells.places);
  PlainFilter next = filter;
  next.nowhere = filter.nowhere * (1 - settings.leave) + (1 - filter.nowhere) * settings.enter;
  double total = next.nowhere;
  for (const CellRun& run : filter.cells.runs)
    for (size_t to = run.first; to < run.first + run.count; ++to) {
      next.masses[to] = 0;
      for (size_t r = 0; r < kRates; ++r) {
        next.rates[r][to] = likelihood(settings, scores[filter.cells.frames[to]]) *
                            (stays * stepped(filter, run, r, to) + lands * filter_rates()[r].prior);
        next.masses[to] += next.rates[r][to];
      }
      total += next.masses[to];
    }
  next.nowhere /= total;
  for (double& mass : next.masses) mass /= total;
  for (std::vector<double>& rate : next.rates)
    for (double& mass : rate) mass /= total;
  filter = std::move(next);
}

double plain_value(const PlainFilter& filter, size_t cell) {
  return -std::log(filter.masses[cell]) / filter.settings.sharpness;
}

double plain_nowhere_value(const PlainFilter& filter) {
  return -std::log(filter.nowhere) / filter.settings.sharpness;
}

double filter_tolerance(size_t views) {
  constexpr double kGroup = 1.0 * kScoresPerLikelihood / kScoreUnit;
  return kGroup * static_cast<double>(views) + 0.006;
}

}  // namespace vpr
