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
  return is_near(cells, first_pass(cells, a), first_pass(cells, b), 2 * near) &&
         !is_near(cells, cells.trained_cell(a), cells.trained_cell(b), 2 * near);
}

uint32_t reference_margin(const FilterCells& cells, const std::vector<uint32_t>& values,
                          size_t best, size_t near) {
  uint32_t least = kNewPathValue;
  for (const CellStretch& run : cells.runs)
    for (size_t cell = run.first; cell < run.first + run.count; ++cell)
      if (!is_near(cells, cell, best, near) &&
          (cells.is_decoy(cell) != cells.is_decoy(best) || !is_other_pass(cells, cell, best, near)))
        least = std::min(least, values[cell]);
  return least - std::min(least, values[best]);
}

// The place of a step back from a cell, at the keyframe before.
size_t place_before(const std::vector<uint32_t>& values, size_t cell) {
  size_t before = cell;
  for (size_t step = 0; step <= kLongestStep; ++step)
    if (values[cell - step] <= values[before]) before = cell - step;
  return before;
}

/// A keyframe when it arrived, and the first keyframe of its path now.
struct Led {
  size_t cell = 0;
  size_t first = 0;
  size_t path = 0;
  bool is_established = false;
  bool is_resumed = false;  ///< another path led then
};

bool is_same(const FilterCells& cells, size_t a, size_t b, size_t near) {
  return is_near(cells, a, b, near) || is_other_pass(cells, a, b, near);
}

// The best place, or one in the pass of the path.
size_t chosen_place(const FilterCells& cells, const std::vector<uint32_t>& values, size_t best,
                    size_t last, size_t near) {
  if (is_near(cells, best, last, near) || !is_other_pass(cells, best, last, near)) return best;
  const CellStretch& run = run_of(cells, last);
  size_t in_pass = last;
  for (size_t cell = run.first + run.count; cell-- > run.first;)
    if (is_near(cells, cell, last, near) && values[cell] <= values[in_pass]) in_pass = cell;
  return values[in_pass] <= values[best] + 5 * kScoreUnit ? in_pass : best;
}

// The place of keyframe k, traced back from the last keyframe at which its path led, at most
// path_keyframes / 2 later.
size_t traced(std::span<const Led> led, std::span<const std::vector<uint32_t>> values, size_t k,
              const FilterSettings& settings) {
  size_t at = std::min(k + settings.path_keyframes / 2, led.size() - 1);
  while (at > k && (led[at].first != led[k].first || led[at].is_resumed)) --at;
  size_t cell = led[at].cell;
  for (; at > k; --at) cell = place_before(values[at - 1], cell);
  return cell;
}

// Adds keyframe k, without margin; `paths`: the largest number of an earlier path.
void lead(std::vector<Led>& led, size_t paths, const FilterCells& cells,
          std::span<const std::vector<uint32_t>> values, const PathTrack& track) {
  const size_t k = led.size();
  const size_t near = track.settings.near_keyframes;
  const size_t best = best_of(cells, values[k], track.follows_decoys);
  Led added{best, k, paths + 1, false, false};
  size_t age = 0;  // of the keyframe from which the path continues
  size_t place = best;
  if (k > 0 && is_same(cells, best, led[k - 1].cell, near)) {
    age = 1;
    place = added.cell = chosen_place(cells, values[k], best, led[k - 1].cell, near);
  }
  size_t led_at = age > 0 ? led[k - 1].cell : 0;
  for (size_t a = 1; age == 0 && a <= std::min(k, track.settings.path_keyframes / 2); ++a) {
    place = place_before(values[k - a], place);
    led_at = traced(led, values, k - a, track.settings);
    if (!is_same(cells, place, led_at, near)) continue;
    if (led[k - a].is_established) break;
    age = a;
  }
  if (age > 0) {
    const Led& from = led[k - age];
    added.first = from.first;
    added.is_established = from.is_established;
    if (is_near(cells, place, led_at, near)) added.path = from.path;
    for (size_t resumed = k - age + 1; resumed < k; ++resumed)
      led[resumed] = {led[resumed].cell, from.first, added.path, false, true};
  }
  led.push_back(added);
}

}  // namespace

ReferenceFilter start_reference_filter(const FilterCells& cells) {
  ReferenceFilter filter{cells, {}, std::vector<double>(cells.size(), 0)};
  filter.rates.assign(kRateCount, std::vector<double>(cells.size(), 0));
  return filter;
}

void advance_reference_filter(ReferenceFilter& filter, std::span<const uint16_t> scores) {
  std::vector<std::vector<double>> next(kRateCount, std::vector<double>(filter.cells.size(), 0));
  for (const CellStretch& run : filter.cells.runs)
    for (size_t cell = run.first; cell < run.first + run.count; ++cell)
      for (size_t rate = 0; rate < kRateCount; ++rate)
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
  std::vector<Led> led;
  std::vector<ReferenceKeyframe> keyframes(values.size());
  size_t paths = 0;
  const auto margin_of = [&](size_t k) -> uint32_t {
    const size_t start = k + 1 - settings.path_keyframes;
    double distance = distances[start];
    double advanced = 0;
    for (size_t view = start + 1; view <= k; ++view) {
      distance += distances[view];
      const double step = static_cast<double>(traced(led, values, view, settings)) -
                          static_cast<double>(traced(led, values, view - 1, settings));
      if (step > 0 && step <= static_cast<double>(settings.near_keyframes)) ++advanced;
    }
    const auto count = static_cast<double>(settings.path_keyframes);
    const double share = distance / count / track.typical_distance;
    const double far = std::clamp((share - 0.5) / (0.8 - 0.5), 0.0, 1.0);
    if (advanced < std::floor(count * (4 + 8 * far) / 16) || !(share <= 1.05)) return 0;
    const double margin = reference_margin(cells, values[k], led[k].cell, settings.near_keyframes);
    return static_cast<uint32_t>(std::max(margin - std::floor(4 * far * kScoreUnit), 0.0));
  };
  for (size_t k = 0; k < values.size(); ++k) {
    lead(led, paths, cells, values, track);
    paths = std::max(paths, led[k].path);
    keyframes[k].path = led[k].path;
    if (k + 1 - led[k].first >= settings.path_keyframes) keyframes[k].margin = margin_of(k);
    if (keyframes[k].margin >= 5 * kScoreUnit) led[k].is_established = true;
  }
  for (size_t k = 0; k < values.size(); ++k) keyframes[k].cell = traced(led, values, k, settings);
  return keyframes;
}

}  // namespace vpr
