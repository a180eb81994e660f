#include "reference/reference_filter.h"

#include <algorithm>
#include <cmath>

#include "match/score_kernels.h"

namespace vpr {
namespace {

double likelihood(uint16_t score) {
  const double z = (static_cast<double>(score) - kScoreBias) / kScoreUnit;
  return std::exp(kSharpness * (kUnrelated - std::min(z, 8.0)));
}

// The mass that steps within the run bring to a cell at a rate, before the observation.
double stepped(const ReferenceFilter& filter, const CellStretch& run, size_t rate, size_t to) {
  const FilterRate& steps = filter_rates()[rate];
  double sum = 0;
  for (size_t s = 0; s < kSteps; ++s) {
    const size_t step = kFirstSteps[rate] + s;
    if (to < run.first + step) continue;
    double all = 0;
    for (const std::vector<double>& masses : filter.rates) all += masses[to - step];
    sum += steps.steps[s] *
           ((1 - kRateChange) * filter.rates[rate][to - step] + kRateChange * steps.prior * all);
  }
  return sum;
}

size_t best_of(const FilterCells& cells, const std::vector<uint32_t>& values, bool follows_decoys) {
  const auto decoys = values.begin() + static_cast<ptrdiff_t>(cells.decoys);
  const auto first = follows_decoys ? decoys : values.begin();
  const auto last = follows_decoys ? values.end() : decoys;
  return static_cast<size_t>(std::min_element(first, last) - values.begin());
}

bool is_near(const FilterCells& cells, size_t a, size_t b, size_t near) {
  const double gap = static_cast<double>(a) - static_cast<double>(b);
  return run_of(cells, a).sequence == run_of(cells, b).sequence &&
         cells.is_decoy(a) == cells.is_decoy(b) && std::abs(gap) <= static_cast<double>(near);
}

size_t first_pass(const FilterCells& cells, size_t cell) {
  const size_t trained = cells.trained_cell(cell);
  return cells.first_passes.empty() ? trained : cells.first_passes[trained];
}

// The same place in another pass, in either direction.
bool is_other_pass(const FilterCells& cells, size_t a, size_t b, size_t near) {
  return is_near(cells, first_pass(cells, a), first_pass(cells, b), near) &&
         !is_near(cells, cells.trained_cell(a), cells.trained_cell(b), near);
}

uint32_t reference_margin(const FilterCells& cells, const std::vector<uint32_t>& values,
                          size_t best, size_t near) {
  uint32_t least = kNewPathValue;
  for (const CellStretch& run : cells.runs)
    for (size_t cell = run.first; cell < run.first + run.count; ++cell)
      if (!is_near(cells, cell, best, near) && !is_other_pass(cells, cell, best, near))
        least = std::min(least, values[cell]);
  return least - std::min(least, values[best]);
}

// The places of a track by keyframe, which stay in their pass.
std::vector<size_t> chosen_places(const FilterCells& cells,
                                  std::span<const std::vector<uint32_t>> values,
                                  const PathTrack& track) {
  const size_t near = track.settings.near_keyframes;
  std::vector<size_t> chosen;
  for (const std::vector<uint32_t>& row : values) {
    size_t best = best_of(cells, row, track.follows_decoys);
    if (!chosen.empty() && is_other_pass(cells, best, chosen.back(), near) &&
        !is_near(cells, best, chosen.back(), near)) {
      const CellStretch& run = run_of(cells, chosen.back());
      size_t in_pass = chosen.back();
      for (size_t cell = run.first + run.count; cell-- > run.first;)
        if (is_near(cells, cell, chosen.back(), near) && row[cell] <= row[in_pass]) in_pass = cell;
      if (row[in_pass] <= row[best] + 5 * kScoreUnit) best = in_pass;
    }
    chosen.push_back(best);
  }
  return chosen;
}

}  // namespace

ReferenceFilter start_reference_filter(const FilterCells& cells) {
  ReferenceFilter filter{cells, {}, std::vector<double>(cells.size(), 0)};
  filter.rates.assign(kRates, std::vector<double>(cells.size(), 0));
  return filter;
}

void advance_reference_filter(ReferenceFilter& filter, std::span<const uint16_t> scores) {
  std::vector<std::vector<double>> next(kRates, std::vector<double>(filter.cells.size(), 0));
  for (const CellStretch& run : filter.cells.runs)
    for (size_t cell = run.first; cell < run.first + run.count; ++cell)
      for (size_t rate = 0; rate < kRates; ++rate)
        next[rate][cell] = likelihood(scores[filter.cells.frames[cell]]) *
                           (stepped(filter, run, rate, cell) + filter_rates()[rate].prior);
  filter.rates = std::move(next);
  std::ranges::fill(filter.masses, 0);
  for (const std::vector<double>& masses : filter.rates)
    for (size_t cell = 0; cell < masses.size(); ++cell) filter.masses[cell] += masses[cell];
  const double most = std::exp(kMostEvidence) / *std::ranges::max_element(filter.masses);
  if (most >= 1) return;
  for (std::vector<double>& masses : filter.rates)
    for (double& mass : masses) mass *= most;
  for (double& mass : filter.masses) mass *= most;
}

double reference_value(const ReferenceFilter& filter, size_t cell) {
  return -std::log(filter.masses[cell]) / kSharpness;
}

std::vector<ReferenceKeyframe> reference_paths(const FilterCells& cells,
                                               std::span<const std::vector<uint32_t>> values,
                                               std::span<const uint32_t> distances,
                                               const PathTrack& track) {
  const FilterSettings& settings = track.settings;
  const size_t near = settings.near_keyframes;
  const std::vector<size_t> best = chosen_places(cells, values, track);
  std::vector<ReferenceKeyframe> keyframes(values.size());
  size_t path = 0;
  // The place of keyframe k, traced back from keyframe `last` or path_keyframes / 2 later.
  const auto traced = [&](size_t k, size_t last) {
    size_t at = std::min(k + settings.path_keyframes / 2, last);
    size_t cell = best[at];
    for (; at > k; --at) {
      size_t before = cell;
      for (size_t step = 0; step <= kLongestStep; ++step)
        if (values[at - 1][cell - step] <= values[at - 1][before]) before = cell - step;
      cell = before;
    }
    return cell;
  };
  const auto margin_at = [&](size_t k) -> uint32_t {
    const size_t start = k + 1 - settings.path_keyframes;
    double distance = distances[start];
    double moved = 0;
    for (size_t view = start + 1; view <= k; ++view) {
      distance += distances[view];
      const double step =
          static_cast<double>(traced(view, k)) - static_cast<double>(traced(view - 1, k));
      if (std::abs(step) <= static_cast<double>(near)) moved += step;
    }
    const auto count = static_cast<double>(settings.path_keyframes);
    return moved >= std::floor(count / 4) && distance <= track.farthest * count
               ? reference_margin(cells, values[k], best[k], near)
               : 0;
  };
  for (size_t first = 0; first < values.size();) {
    size_t end = first + 1;  // of the path
    while (end < values.size() && (is_near(cells, best[end - 1], best[end], near) ||
                                   is_other_pass(cells, best[end - 1], best[end], near)))
      ++end;
    for (size_t k = first; k < end; ++k) {
      if (k == first || !is_near(cells, best[k - 1], best[k], near)) ++path;
      keyframes[k] = {path, k + 1 - first >= settings.path_keyframes ? margin_at(k) : 0,
                      traced(k, end - 1)};
    }
    first = end;
  }
  return keyframes;
}

}  // namespace vpr
