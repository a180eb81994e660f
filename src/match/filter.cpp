#include "match/filter.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/error.h"
#include "base/exponentials.h"
#include "base/parallel.h"
#include "match/score_kernels.h"

namespace vpr {

namespace {

constexpr size_t kChunkCells = 32768;  // per task; sums are added chunk by chunk
constexpr size_t kPartialSums = 8;
constexpr double kWorstZ = 8;  // larger values are clamped
constexpr uint32_t kMantissas = 1024;
constexpr uint32_t kMantissaShift = 13;  // the upper 10 of a float's 23 mantissa bits are looked up
constexpr uint32_t kFraction = 256;      // units of logarithms per unit of values

constexpr std::array<FilterRate, kRates> kFilterRates = {{
    {0.02, {1, 0, 0}},
    {0.06, {0.5, 0.5, 0}},
    {0.1, {0.34, 0.65, 0.01}},
    {0.64, {0.05, 0.9, 0.05}},
    {0.1, {0.5, 0.49, 0.01}},
    {0.08, {0.05, 0.9, 0.05}},
}};

// exp(-sharpness * (z - unmatched)), for z in the middle of kScoresPerLikelihood scores.
std::vector<float> likelihood_table(const FilterSettings& settings) {
  constexpr size_t kEntries = 65536 / kScoresPerLikelihood;
  std::vector<double> powers;
  for (size_t k = 0; k < kEntries; ++k) {
    const double score = (static_cast<double>(k) + 0.5) * kScoresPerLikelihood;
    const double z = std::min((score - kScoreBias) / kScoreUnit, kWorstZ);
    powers.push_back(-settings.sharpness * z);
  }
  powers.push_back(-settings.sharpness * settings.unmatched);
  exponentiate(powers);
  std::vector<float> table(kEntries);
  for (size_t k = 0; k < kEntries; ++k) table[k] = static_cast<float>(powers[k] / powers.back());
  return table;
}

// ln((1 + y) / (1 - y)) = 2 (y + y^3 / 3 + y^5 / 5 ...), by operations that every machine rounds
// the same way; |y| <= 1/3.
double natural_logarithm(double x) {
  const double y = (x - 1) / (x + 1);
  double power = y;
  double sum = 0;
  for (int k = 1; k <= 35; k += 2) {
    sum += power / k;
    power *= y * y;
  }
  return 2 * sum;
}

uint32_t logarithm(const FilterState& state, float mass) {
  const auto bits = std::bit_cast<uint32_t>(mass);
  return (bits >> 23) * state.octave +
         state.logarithms[(bits >> kMantissaShift) & (kMantissas - 1)];
}

void find_likelihoods(FilterState& state, std::span<const uint16_t> scores, size_t first,
                      size_t last) {
  const FilterCells& cells = state.cells;
  for (const CellRun& run : cells.runs) {
    const size_t end = std::min(last, run.first + run.count);
    for (size_t cell = std::max(first, run.first); cell < end; ++cell)
      state.likelihoods[cell] =
          state.likelihood_of[scores[cells.frames[cell]] / kScoresPerLikelihood];
  }
}

double sum_masses(const FilterState& state, size_t first, size_t last) {
  std::array<double, kPartialSums> sums = {};
  size_t cell = first;
  for (; cell + kPartialSums <= last; cell += kPartialSums)
    for (size_t k = 0; k < kPartialSums; ++k) sums[k] += state.masses[cell + k];
  for (size_t k = 0; cell + k < last; ++k) sums[k] += state.masses[cell + k];
  return std::accumulate(sums.begin(), sums.end(), 0.0);
}

FilterStep next_step(const FilterState& state) {
  const FilterSettings& settings = state.settings;
  const double off_map = state.off_map / state.total;
  const double kept = (1 - settings.jump) * (1 - settings.enter) / state.total;
  const double entering =
      ((1 - off_map) * settings.jump * (1 - settings.enter) + off_map * settings.leave) /
      static_cast<double>(state.cells.places);
  FilterStep step;
  for (size_t r = 0; r < kRates; ++r) {
    const FilterRate& rate = kFilterRates[r];
    for (size_t s = 0; s < kSteps; ++s)
      step.weights[r][s] = static_cast<float>(rate.steps[s] * kept);
    step.entering[r] = static_cast<float>(rate.prior * entering);
    step.change[r] = static_cast<float>(settings.rate_change * rate.prior);
  }
  step.stay = static_cast<float>(1 - settings.rate_change);
  return step;
}

// Calls body(first, last) for chunks of cells in several threads.
template <class Body>
void for_chunks(size_t cells, const Body& body) {
  const size_t chunks = (cells - kLongestStep + kChunkCells - 1) / kChunkCells;
  const auto chunk = [&](size_t c) {
    const size_t first = kLongestStep + c * kChunkCells;
    body(c, first, std::min(first + kChunkCells, cells));
  };
  if (chunks == 1) return chunk(0);
  parallel_for(chunks, Monitor{}, chunk);
}

void find_values(FilterState& state) {
  const uint32_t whole = logarithm(state, static_cast<float>(state.total));
  const auto value_of = [&](float mass) {
    return kScoreBias + (whole - std::min(whole, logarithm(state, mass))) / kFraction;
  };
  state.nowhere_value = value_of(static_cast<float>(state.off_map));
  for_chunks(state.cells.size(), [&](size_t, size_t first, size_t last) {
    for (size_t cell = first; cell < last; ++cell)
      state.values[cell] = state.masses[cell] > 0 ? value_of(state.masses[cell]) : kNoValue;
  });
}

constexpr uint16_t kWorstScore = std::numeric_limits<uint16_t>::max();

double deviations(uint16_t score) { return (static_cast<double>(score) - kScoreBias) / kScoreUnit; }

uint16_t score_of(double distance, const ScoreScale& scale) {
  const double z = (distance - scale.mean) / scale.deviation;
  return static_cast<uint16_t>(
      std::clamp(std::floor((z * kScoreUnit + kScoreBias) + 0.5), 0.0, 65535.0));
}

size_t end_of(const PathKeyframe& view) { return view.first + view.distances.size(); }

/// Cells [first, end) of one run.
struct Stretch {
  size_t first = 0;
  size_t end = 0;
};

Stretch around_path(const std::vector<const PathKeyframe*>& views) {
  Stretch stretch{views.front()->first, 0};
  for (const PathKeyframe* view : views) {
    stretch.first = std::min(stretch.first, view->first);
    stretch.end = std::max(stretch.end, end_of(*view));
  }
  return stretch;
}

// `places`: of the whole map, because the off-map state can return to any of them.
FilterCells cells_of(const Stretch& stretch, size_t places) {
  const size_t count = stretch.end - stretch.first;
  FilterCells cells;
  cells.frames.resize(kLongestStep + count, 0);
  std::iota(cells.frames.begin() + kLongestStep, cells.frames.end(), 0U);
  cells.runs.push_back({kLongestStep, count, 0, count});
  cells.places = places;
  return cells;
}

// The margin for the last keyframe of a filter whose cells are `stretch`.
uint32_t margin_near(const FilterState& filter, const Stretch& stretch, size_t best) {
  const size_t near = filter.settings.near_keyframes;
  const size_t first = std::max(stretch.first, best - std::min(best, near));
  const size_t end = std::min(stretch.end, best + near + 1);
  const auto value = [&](size_t cell) {
    return filter.values.begin() + static_cast<ptrdiff_t>(kLongestStep + cell - stretch.first);
  };
  const uint32_t least = *std::min_element(value(first), value(end));
  return filter.nowhere_value - std::min(filter.nowhere_value, least);
}

}  // namespace

const std::array<FilterRate, kRates>& filter_rates() { return kFilterRates; }

void check_filter(const FilterSettings& settings) {
  require_range("filter.keyframe_change", settings.keyframe_change, 0, 10);
  require_range("filter.sharpness", settings.sharpness, 0.05, 2);
  require_range("filter.unmatched", settings.unmatched, -8, 8);
  require_range("filter.jump", settings.jump, 1e-9, 0.5);
  require_range("filter.enter", settings.enter, 1e-9, 0.5);
  require_range("filter.leave", settings.leave, 1e-9, 0.5);
  require_range("filter.rate_change", settings.rate_change, 1e-9, 0.5);
  require_range("filter.near_keyframes", static_cast<double>(settings.near_keyframes), 0, 1e6);
  require_range("filter.confirm_keyframes", static_cast<double>(settings.confirm_keyframes), 0,
                1e6);
  require_range("filter.confirm_margin", settings.confirm_margin, 0, 1000);
  require_range("filter.support", settings.support, -32, 32);
  require_range("filter.confirm_evidence", settings.confirm_evidence, 0, 1e6);
  require_range("filter.present_support", settings.present_support, 0, 2.5);
}

FilterState start_filter(const FrameDistances& distances, const FilterSettings& settings,
                         double least_change) {
  check_filter(settings);
  FilterState state;
  state.settings = settings;
  state.kernels = select_filter_kernels();
  state.likelihood_of = likelihood_table(settings);
  const double octave = kScoreUnit * kFraction / settings.sharpness;
  for (uint32_t m = 0; m < kMantissas; ++m)
    state.logarithms.push_back(
        static_cast<uint32_t>(std::lround(octave * natural_logarithm(1 + (m + 0.5) / kMantissas))));
  state.octave = static_cast<uint32_t>(std::lround(octave * natural_logarithm(2)));
  place_filter(state, find_cells(distances, least_change));
  return state;
}

void place_filter(FilterState& state, FilterCells cells) {
  state.cells = std::move(cells);
  for (size_t r = 0; r < kRates; ++r) {
    state.before[r].assign(state.cells.size(), 0);
    state.after[r].assign(state.cells.size(), 0);
  }
  state.likelihoods.assign(state.cells.size(), 0);
  state.masses.assign(state.cells.size(), 0);
  state.values.assign(state.cells.size(), kNoValue);
  restart_filter(state);
}

void restart_filter(FilterState& state) {
  state.off_map = 0.5;
  state.total = 1;
  const double everywhere = 0.5 / static_cast<double>(std::max<size_t>(state.cells.places, 1));
  for (size_t r = 0; r < kRates; ++r) {
    // Changes of the rate do not change the priors.
    const double each = everywhere * kFilterRates[r].prior;
    for (const CellRun& run : state.cells.runs)
      std::fill_n(state.before[r].begin() + static_cast<ptrdiff_t>(run.first), run.count,
                  static_cast<float>(each));
  }
}

void advance_filter(FilterState& state, std::span<const uint16_t> scores) {
  if (state.cells.places == 0) return;
  const FilterStep step = next_step(state);
  ConstRateArrays before;
  RateArrays after;
  for (size_t r = 0; r < kRates; ++r) {
    before[r] = state.before[r].data();
    after[r] = state.after[r].data();
  }
  std::vector<double> sums(state.cells.size() / kChunkCells + 1);
  for_chunks(state.cells.size(), [&](size_t chunk, size_t first, size_t last) {
    find_likelihoods(state, scores, first, last);
    state.kernels.step(step, state.likelihoods.data(), before, after, state.masses.data(), first,
                       last - first);
    sums[chunk] = sum_masses(state, first, last);
  });
  std::swap(state.before, state.after);
  const double off_map = state.off_map / state.total;
  state.off_map = off_map * (1 - state.settings.leave) + (1 - off_map) * state.settings.enter;
  state.total = std::accumulate(sums.begin(), sums.end(), state.off_map);
  find_values(state);
}

FilterCells find_cells(const FrameDistances& distances, double least_change) {
  FilterCells cells;
  for (const FrameRun& run : distances.train_runs) {
    const DescriptorRows& rows = distances.train[run.sequence].rows;
    cells.frames.resize(cells.frames.size() + kLongestStep, 0);
    CellRun& added =
        cells.runs.emplace_back(CellRun{cells.size(), 0, run.sequence, run.first + run.count});
    size_t last = run.first_in_sequence;
    for (size_t k = 0; k < run.count; ++k) {
      const size_t frame = run.first_in_sequence + k;
      if (k > 0 && frame_distance(rows, last, frame) < least_change) continue;
      last = frame;
      cells.frames.push_back(static_cast<uint32_t>(run.first + k));
    }
    added.count = cells.size() - added.first;
    cells.places += added.count;
  }
  return cells;
}

const CellRun& run_of(const FilterCells& cells, size_t cell) {
  const auto behind = std::upper_bound(cells.runs.begin(), cells.runs.end(), cell,
                                       [](size_t c, const CellRun& run) { return c < run.first; });
  assert(behind != cells.runs.begin());
  return *std::prev(behind);
}

size_t view_end(const FilterCells& cells, const CellRun& run, size_t cell) {
  return cell + 1 < run.first + run.count ? cells.frames[cell + 1] : run.frames_end;
}

Rescoring start_rescoring(const FilterState& filter) {
  Rescoring rescoring;
  rescoring.filter.settings = filter.settings;
  rescoring.filter.kernels = filter.kernels;
  rescoring.filter.likelihood_of = filter.likelihood_of;
  rescoring.filter.logarithms = filter.logarithms;
  rescoring.filter.octave = filter.octave;
  return rescoring;
}

void add_keyframe(Rescoring& rescoring, const FilterCells& cells, std::span<const uint16_t> scores,
                  const std::function<ScoreScale(size_t)>& scale, size_t cell) {
  const size_t near = rescoring.filter.settings.near_keyframes;
  const CellRun& run = run_of(cells, cell);
  PathKeyframe view{cell, std::max(run.first, cell - std::min(cell, near)), {}};
  const size_t end = std::min(run.first + run.count, cell + near + 1);
  for (size_t c = view.first; c < end; ++c) {
    const ScoreScale made = scale(cells.frames[c]);
    view.distances.push_back(made.mean + made.deviation * deviations(scores[cells.frames[c]]));
  }
  rescoring.views.push_back(std::move(view));
  if (rescoring.views.size() > kRescoredKeyframes) rescoring.views.pop_front();
}

RescoredPath rescore(Rescoring& rescoring, const FilterCells& cells,
                     const std::function<ScoreScale(size_t)>& scale) {
  assert(!rescoring.views.empty());
  const PathKeyframe& last = rescoring.views.back();
  const CellRun& run = run_of(cells, last.best);
  std::vector<const PathKeyframe*> of_run;
  for (const PathKeyframe& view : rescoring.views)
    if (view.first >= run.first && view.first < run.first + run.count) of_run.push_back(&view);
  const Stretch stretch = around_path(of_run);
  std::vector<ScoreScale> scales;
  for (size_t c = stretch.first; c < stretch.end; ++c) scales.push_back(scale(cells.frames[c]));

  RescoredPath reading;
  for (const PathKeyframe& view : rescoring.views) {
    const uint16_t score =
        score_of(view.distances[view.best - view.first], scale(cells.frames[view.best]));
    reading.supports.push_back(static_cast<int32_t>(kScoreBias) - score);
  }
  place_filter(rescoring.filter, cells_of(stretch, cells.places));
  std::vector<uint16_t> scores(stretch.end - stretch.first);
  for (const PathKeyframe* view : of_run) {
    std::fill(scores.begin(), scores.end(), kWorstScore);
    const size_t offset = view->first - stretch.first;
    for (size_t k = 0; k < view->distances.size(); ++k)
      scores[offset + k] = score_of(view->distances[k], scales[offset + k]);
    advance_filter(rescoring.filter, scores);
  }
  reading.margin = margin_near(rescoring.filter, stretch, last.best);
  return reading;
}

}  // namespace vpr
