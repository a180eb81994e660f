// Compiled once per SIMD target: see Highway's foreach_target.h.
#include "match/filter.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/exponentials.h"
#include "base/parallel.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "match/filter.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#ifndef VPR_FILTER_ONCE
#define VPR_FILTER_ONCE
namespace vpr {
namespace {

/// A mass per rate and cell.
using RateMasses = std::array<std::vector<float>, kRateCount>;

/// The constants of one step, equal for all cells.
struct FilterStep {
  /// By rate and step: its probability, times the normalization of masses.
  std::array<std::array<float, kSteps>, kRateCount> weights;
  std::array<float, kRateCount> entering;  ///< mass of the paths that begin at each cell
  std::array<float, kRateCount> change;    ///< share of a cell's mass that changes to the rate
  float stay = 0;                          ///< share of a rate's mass that stays with it
};

}  // namespace
}  // namespace vpr
#endif

HWY_BEFORE_NAMESPACE();
namespace vpr {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// A vector with one cell per lane of the tag.
template <class Tag>
HWY_INLINE void StepCells(Tag d, const FilterStep& step, const float* likelihoods,
                          const RateMasses& before, RateMasses& after, float* masses, size_t cell) {
  const auto likelihood = hn::LoadU(d, likelihoods + cell);
  hn::Vec<Tag> fresh[kRateCount];
  for (size_t r = 0; r < kRateCount; ++r) {
    const float* from = before[r].data() + cell - kFirstSteps[r];
    auto sum = hn::Mul(hn::Set(d, step.weights[r][0]), hn::LoadU(d, from));
    sum = hn::Add(sum, hn::Mul(hn::Set(d, step.weights[r][1]), hn::LoadU(d, from - 1)));
    sum = hn::Add(sum, hn::Mul(hn::Set(d, step.weights[r][2]), hn::LoadU(d, from - 2)));
    fresh[r] = hn::Mul(likelihood, hn::Add(sum, hn::Set(d, step.entering[r])));
  }
  auto mass = fresh[0];
  for (size_t r = 1; r < kRateCount; ++r) mass = hn::Add(mass, fresh[r]);
  hn::StoreU(mass, d, masses + cell);
  const auto stay = hn::Set(d, step.stay);
  for (size_t r = 0; r < kRateCount; ++r)
    hn::StoreU(hn::Add(hn::Mul(stay, fresh[r]), hn::Mul(hn::Set(d, step.change[r]), mass)), d,
               after[r].data() + cell);
}

// For cells [first, first + count) and every rate r, with s = kFirstSteps[r]:
//   new(r) = likelihood * (((w0 * before(cell - s) + w1 * before(cell - s - 1)) +
//            w2 * before(cell - s - 2)) + entering)
// mass = the sum of new(r), in the order of rates, and after(r) = stay * new(r) + change * mass.
// Single operations, never fused: all targets give the same bits. Reads the kLongestStep cells
// before `first`; arrays must not overlap.
void Step(const FilterStep& step, const float* likelihoods, const RateMasses& before,
          RateMasses& after, float* masses, size_t first, size_t count) {
  const hn::ScalableTag<float> many;
  const hn::CappedTag<float, 1> one;
  const size_t lanes = hn::Lanes(many);
  const size_t end = first + count;
  size_t cell = first;
  for (; cell + lanes <= end; cell += lanes)
    StepCells(many, step, likelihoods, before, after, masses, cell);
  for (; cell < end; ++cell) StepCells(one, step, likelihoods, before, after, masses, cell);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace vpr
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace vpr {

HWY_EXPORT(Step);

namespace {

constexpr size_t kChunkCells = 32768;  // per task; sums are added chunk by chunk
constexpr size_t kPartialMaxima = 8;
constexpr double kWorstZ = 8;  // larger values are clamped
constexpr uint32_t kMantissas = 1024;
constexpr uint32_t kMantissaShift = 13;  // the upper 10 of a float's 23 mantissa bits are looked up
constexpr uint32_t kFraction = 256;      // units of logarithms per unit of values

constexpr std::array<FilterRate, kRateCount> kFilterRates = {{
    {0.05, {1, 0, 0}},
    {0.06, {0.5, 0.5, 0}},
    {0.1, {0.34, 0.65, 0.01}},
    {0.61, {0.05, 0.9, 0.05}},
    {0.1, {0.5, 0.49, 0.01}},
    {0.08, {0.05, 0.9, 0.05}},
}};

// exp(kSharpness * (kUnrelated - z)), for z in the middle of kScoresPerLikelihood scores.
std::vector<float> likelihood_table() {
  constexpr size_t kEntries = 65536 / kScoresPerLikelihood;
  std::vector<double> powers;
  for (size_t k = 0; k < kEntries; ++k) {
    const double score = (static_cast<double>(k) + 0.5) * kScoresPerLikelihood;
    const double z = std::min((score - kScoreBias) / kScoreUnit, kWorstZ);
    powers.push_back(kSharpness * (kUnrelated - z));
  }
  powers.push_back(0);
  exponentiate(powers);
  std::vector<float> table(kEntries);
  for (size_t k = 0; k < kEntries; ++k) table[k] = static_cast<float>(powers[k] / powers.back());
  return table;
}

uint32_t logarithm(const FilterState& state, float mass) {
  const auto bits = std::bit_cast<uint32_t>(mass);
  return (bits >> 23) * state.octave +
         state.logarithms[(bits >> kMantissaShift) & (kMantissas - 1)];
}

void find_likelihoods(FilterState& state, std::span<const uint16_t> scores, size_t first,
                      size_t last) {
  const FilterCells& cells = state.cells;
  for (const CellStretch& run : cells.runs) {
    const size_t end = std::min(last, run.first + run.count);
    for (size_t cell = std::max(first, run.first); cell < end; ++cell)
      state.likelihoods[cell] =
          cells.trained_cell(cell) < state.known
              ? state.likelihood_of[scores[cells.frames[cell]] / kScoresPerLikelihood]
              : 0;
  }
}

FilterStep next_step(const FilterState& state) {
  FilterStep step;
  for (size_t r = 0; r < kRateCount; ++r) {
    const FilterRate& rate = kFilterRates[r];
    for (size_t k = 0; k < kSteps; ++k)
      step.weights[r][k] = static_cast<float>(rate.steps[k] * state.kept);
    step.entering[r] = static_cast<float>(rate.prior);
    step.change[r] = static_cast<float>(kRateChange * rate.prior);
  }
  step.stay = static_cast<float>(1 - kRateChange);
  return step;
}

// Calls body(chunk, first, last) for chunks of the known cells and their decoys in several threads.
template <class Body>
void for_chunks(const FilterState& state, const Body& body) {
  const size_t known = std::clamp(state.known, kLongestStep, state.cells.decoys);
  const size_t decoys = state.cells.size() + kLongestStep - known;
  const size_t chunks = (known - kLongestStep + kChunkCells - 1) / kChunkCells;
  const auto chunk = [&](size_t c) {
    const size_t skipped = c % chunks * kChunkCells;
    const size_t first = (c < chunks ? kLongestStep : decoys) + skipped;
    const size_t end = c < chunks ? known : state.cells.size();
    body(c, first, std::min(first + kChunkCells, end));
  };
  if (chunks == 1) {
    chunk(0);
    return chunk(1);
  }
  parallel_for(2 * chunks, Monitor{}, chunk);
}

float largest_mass(const FilterState& state, size_t first, size_t last) {
  std::array<float, kPartialMaxima> largest = {};
  size_t cell = first;
  for (; cell + kPartialMaxima <= last; cell += kPartialMaxima)
    for (size_t k = 0; k < kPartialMaxima; ++k)
      largest[k] = std::max(largest[k], state.masses[cell + k]);
  for (; cell < last; ++cell) largest[0] = std::max(largest[0], state.masses[cell]);
  return *std::ranges::max_element(largest);
}

void find_values(FilterState& state) {
  const uint32_t one = logarithm(state, 1);
  const uint32_t most =
      kNewPathValue * kFraction + 2 * one - logarithm(state, static_cast<float>(state.kept));
  for_chunks(state, [&](size_t, size_t first, size_t last) {
    for (size_t cell = first; cell < last; ++cell) {
      const float mass = state.masses[cell];
      state.values[cell] = mass > 0 ? (most - logarithm(state, mass)) / kFraction : kNoValue;
    }
  });
}

// The mean distance of consecutive keyframes; nullopt without any. Every frame is a keyframe at
// least_change 0.
std::optional<double> mean_step(const FrameDistances& distances, double least_change) {
  uint64_t sum = 0;
  size_t steps = 0;
  for (const FrameStretch& run : distances.train_runs) {
    const DescriptorRows& rows = distances.train[run.sequence].rows;
    size_t last = run.first_in_sequence;
    for (size_t k = 1; k < run.count; ++k) {
      const uint32_t distance = frame_distance(rows, last, run.first_in_sequence + k);
      if (distance < least_change) continue;
      last = run.first_in_sequence + k;
      sum += distance;
      ++steps;
    }
  }
  if (sum == 0) return std::nullopt;
  return static_cast<double>(sum) / static_cast<double>(steps);
}

}  // namespace

const std::array<FilterRate, kRateCount>& filter_rates() { return kFilterRates; }

void check_filter(const FilterSettings& settings) {
  require_range("filter.start_weight", settings.start_weight, 0, 1e6);
  require_range("filter.keyframe_change", settings.keyframe_change, 0, 10);
  require_range("filter.near_keyframes", static_cast<double>(settings.near_keyframes), 0, 1e6);
  require_range("filter.path_keyframes", static_cast<double>(settings.path_keyframes), 0, 1000);
}

FilterCells find_cells(const FrameDistances& distances, double least_change) {
  FilterCells cells;
  for (const FrameStretch& run : distances.train_runs) {
    const DescriptorRows& rows = distances.train[run.sequence].rows;
    cells.frames.resize(cells.frames.size() + kLongestStep, 0);
    CellStretch& added =
        cells.runs.emplace_back(CellStretch{cells.size(), 0, run.sequence, run.first + run.count});
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
  add_decoys(cells);
  return cells;
}

FilterSettings adapted_settings(const FrameDistances& distances, const FilterSettings& settings,
                                double typical_distance) {
  constexpr double kSparse = 0.35;  // mean changes per frame, in typical distances
  constexpr double kDense = 0.2;
  constexpr double kMostChange = 1.0 / 3;  // additional share of keyframe_change
  constexpr double kNearChange = 0.4;      // typical distances per near keyframe of the settings
  const auto change = mean_step(distances, 0);
  if (!change) return settings;
  FilterSettings adapted = settings;
  const double dense =
      std::clamp((kSparse - *change / typical_distance) / (kSparse - kDense), 0.0, 1.0);
  adapted.keyframe_change *= 1 + kMostChange * dense;
  const auto step = mean_step(distances, adapted.keyframe_change * typical_distance);
  if (!step) return adapted;
  const auto near = static_cast<double>(settings.near_keyframes);
  const double wanted = near * kNearChange * typical_distance / *step;
  adapted.near_keyframes = static_cast<uint64_t>(std::clamp(wanted, near, 1.5 * near));
  return adapted;
}

FilterState start_filter(const FrameDistances& distances, const FilterSettings& settings,
                         double least_change) {
  return start_filter(find_cells(distances, least_change), settings);
}

FilterState start_filter(FilterCells cells, const FilterSettings& settings) {
  check_filter(settings);
  FilterState state;
  state.likelihood_of = likelihood_table();
  const double octave = kScoreUnit * kFraction / kSharpness;
  for (uint32_t m = 0; m < kMantissas; ++m)
    state.logarithms.push_back(
        static_cast<uint32_t>(std::lround(octave * natural_logarithm(1 + (m + 0.5) / kMantissas))));
  state.octave = static_cast<uint32_t>(std::lround(octave * natural_logarithm(2)));
  state.cells = std::move(cells);
  for (size_t r = 0; r < kRateCount; ++r) {
    state.before[r].assign(state.cells.size(), 0);
    state.after[r].assign(state.cells.size(), 0);
  }
  state.likelihoods.assign(state.cells.size(), 0);
  state.masses.assign(state.cells.size(), 0);
  state.values.assign(state.cells.size(), kNoValue);
  state.earlier.assign(settings.path_keyframes / 2, state.values);
  return state;
}

void restart_filter(FilterState& state) {
  for (std::vector<float>& masses : state.before) std::ranges::fill(masses, 0.0F);
  state.kept = 1;
}

void advance_filter(FilterState& state, std::span<const uint16_t> scores) {
  if (state.cells.places == 0) return;
  const FilterStep step = next_step(state);
  std::vector<float> largest(state.cells.size() / kChunkCells + 2);
  for_chunks(state, [&](size_t chunk, size_t first, size_t last) {
    find_likelihoods(state, scores, first, last);
    HWY_DYNAMIC_DISPATCH(Step)
    (step, state.likelihoods.data(), state.before, state.after, state.masses.data(), first,
     last - first);
    largest[chunk] = largest_mass(state, first, last);
  });
  std::swap(state.before, state.after);
  if (!state.earlier.empty()) {
    std::rotate(state.earlier.begin(), state.earlier.end() - 1, state.earlier.end());
    std::swap(state.values, state.earlier.front());
  }
  state.kept = std::min(1.0, kMostMass / *std::ranges::max_element(largest));
  find_values(state);
}

void add_decoys(FilterCells& cells) {
  cells.decoys = cells.size();
  for (size_t r = cells.runs.size(); r-- > 0;) {
    CellStretch run = cells.runs[r];
    const auto first = cells.frames.begin() + static_cast<ptrdiff_t>(run.first);
    std::vector<uint32_t> frames(first, first + static_cast<ptrdiff_t>(run.count));
    cells.frames.resize(cells.size() + kLongestStep, 0);
    run.first = cells.size();
    cells.frames.insert(cells.frames.end(), frames.rbegin(), frames.rend());
    cells.runs.push_back(run);
  }
}

const CellStretch& run_of(const FilterCells& cells, size_t cell) {
  const auto behind = std::ranges::upper_bound(cells.runs, cell, {}, &CellStretch::first);
  assert(behind != cells.runs.begin());
  return *std::prev(behind);
}

void apply_passes(FilterCells& cells, std::span<const RepeatedPlace> passes) {
  if (passes.empty()) return;
  cells.first_passes.resize(cells.decoys);
  std::iota(cells.first_passes.begin(), cells.first_passes.end(), 0U);
  const auto cell_of = [&](uint32_t frame) -> std::optional<size_t> {
    for (const CellStretch& run : cells.trained()) {
      if (frame >= run.frames_end || frame < cells.frames[run.first]) continue;
      const auto first = cells.frames.begin() + static_cast<ptrdiff_t>(run.first);
      const auto after = std::upper_bound(first, first + static_cast<ptrdiff_t>(run.count), frame);
      return static_cast<size_t>(after - cells.frames.begin()) - 1;
    }
    return std::nullopt;
  };
  for (const RepeatedPlace& repeated : passes) {
    const auto cell = cell_of(repeated.frame);
    const auto first = cell_of(repeated.first_pass);
    if (cell && first) cells.first_passes[*cell] = static_cast<uint32_t>(*first);
  }
}

CellRange same_place(const FilterCells& cells, size_t cell, size_t near) {
  const size_t trained = cells.trained_cell(cell);
  const size_t place = cells.first_passes.empty() ? trained : cells.first_passes[trained];
  const size_t sequence = run_of(cells, place).sequence;
  const std::span<const CellStretch> runs = cells.trained();
  const auto is_of_sequence = [&](const CellStretch& run) { return run.sequence == sequence; };
  const auto first = std::ranges::find_if(runs, is_of_sequence);
  const auto last = std::find_if_not(first, runs.end(), is_of_sequence) - 1;
  return {std::max(first->first, place - std::min(place, near)),
          std::min(last->first + last->count, place + near + 1)};
}

const FrameStretch& stretch_of(const FilterCells& cells, const FrameDistances& distances,
                               size_t cell) {
  const auto run = static_cast<size_t>(&run_of(cells, cell) - cells.runs.data());
  return distances.train_runs[std::min(run, cells.runs.size() - 1 - run)];
}

DescriptorRow descriptor_of(const FilterCells& cells, const FrameDistances& distances,
                            size_t cell) {
  const FrameStretch& run = stretch_of(cells, distances, cell);
  return distances.train[run.sequence].rows[cells.frames[cell] - run.first + run.first_in_sequence];
}

size_t keyframe_end(const FilterCells& cells, const CellStretch& run, size_t cell) {
  return cell + 1 < run.first + run.count ? cells.frames[cell + 1] : run.frames_end;
}

}  // namespace vpr

#endif  // HWY_ONCE
