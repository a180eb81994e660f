// The filter over places and rates as it is stated, in double precision: the oracle.
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "matching/filter.h"
#include "matching/score_kernels.h"

namespace vpr {

struct PlainFilter {
  FilterCells cells;
  FilterSettings settings;
  std::vector<std::vector<double>> rates;  ///< mass by rate and cell
  std::vector<double> masses;              ///< of all rates
  double nowhere = 0.5;
  double total = 1;
};

inline PlainFilter start_plain_filter(const FilterCells& cells, const FilterSettings& settings) {
  PlainFilter filter{cells, settings, {}, std::vector<double>(cells.size()), 0.5, 1};
  for (size_t r = 0; r < kRates; ++r) {
    std::vector<double>& rate = filter.rates.emplace_back(cells.size());
    for (const CellRun& run : cells.runs)
      for (size_t c = run.first; c < run.first + run.count; ++c)
        rate[c] = 0.5 * filter_rates()[r].prior / static_cast<double>(cells.places);
  }
  return filter;
}

inline void advance_plain_filter(PlainFilter& filter, std::span<const uint16_t> scores) {
  const FilterSettings& settings = filter.settings;
  const double nowhere = filter.nowhere / filter.total;
  const double jumps =
      (1 - nowhere) * (1 - settings.enter) * settings.jump + nowhere * settings.leave;
  const std::vector<std::vector<double>> before = filter.rates;
  std::fill(filter.masses.begin(), filter.masses.end(), 0);
  filter.nowhere = nowhere * (1 - settings.leave) + (1 - nowhere) * settings.enter;
  filter.total = filter.nowhere;
  for (const CellRun& run : filter.cells.runs)
    for (size_t to = run.first; to < run.first + run.count; ++to) {
      const double z = (scores[filter.cells.frames[to]] - double{kScoreBias}) / kScoreUnit;
      const double likelihood =
          std::exp(-settings.sharpness * (std::min(z, 8.0) - settings.unmatched));
      for (size_t r = 0; r < kRates; ++r) {
        const double prior = filter_rates()[r].prior;
        double sum = jumps * prior / static_cast<double>(filter.cells.places);
        for (size_t s = 0; s < kSteps; ++s) {
          const size_t step = kFirstSteps[r] + s;
          if (to < run.first + step) continue;
          double all = 0;
          for (size_t q = 0; q < kRates; ++q) all += before[q][to - step];
          const double turned = (1 - settings.rate_change) * before[r][to - step] +
                                settings.rate_change * prior * all;
          sum += (1 - settings.enter) * (1 - settings.jump) * filter_rates()[r].steps[s] * turned;
        }
        filter.rates[r][to] = likelihood * sum;
        filter.masses[to] += filter.rates[r][to];
      }
      filter.total += filter.masses[to];
    }
  for (std::vector<double>& rate : filter.rates)
    for (double& mass : rate) mass /= filter.total;
  for (double& mass : filter.masses) mass /= filter.total;
  filter.nowhere /= filter.total;
  filter.total = 1;
}

/// -log(mass / total) / sharpness
inline double plain_value(const PlainFilter& filter, size_t cell) {
  return -std::log(filter.masses[cell]) / filter.settings.sharpness;
}

inline double plain_nowhere_value(const PlainFilter& filter) {
  return -std::log(filter.nowhere) / filter.settings.sharpness;
}

}  // namespace vpr
