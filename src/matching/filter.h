// A forward filter over places and rates: where the query is, at whatever pace it goes, or nowhere.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "matching/filter_cells.h"
#include "matching/filter_kernels.h"
#include "matching/filter_settings.h"

namespace vpr {

/// How likely a rate is before anything was seen, and each of its steps: kFirstSteps[r] views of
/// the training sequence per view of the query, and on.
struct FilterRate {
  double prior = 0;
  std::array<double, kSteps> steps = {};
};
const std::array<FilterRate, kRates>& filter_rates();

/// What is believed after some views of a query: masses of all cells and rates, up to a factor.
/// 60 bytes a place, and 4 for its value.
struct FilterState {
  FilterSettings settings;
  FilterCells cells;
  FilterKernels kernels;
  std::vector<float> likelihood_of;  ///< by score / kScoresPerLikelihood
  std::vector<uint32_t> logarithms;  ///< of mantissas, in units of values / 256
  uint32_t octave = 0;               ///< what a factor of 2 is, in the same units

  std::vector<float> likelihoods;                 ///< of the view; 0 for a cell that is no place
  std::array<std::vector<float>, kRates> before;  ///< by rate: after changes of rate
  std::array<std::vector<float>, kRates> after;
  std::vector<float> masses;     ///< of every cell, over rates
  double nowhere = 0;            ///< mass of being nowhere
  double total = 1;              ///< all mass
  std::vector<uint32_t> values;  ///< of every cell: kScoreBias and -log(mass / total) / sharpness
  uint32_t nowhere_value = 0;
};

/// Scores that differ by less have one likelihood: 1/64 of a deviation.
inline constexpr uint32_t kScoresPerLikelihood = 16;

/// The value of a cell that is no place.
inline constexpr uint32_t kNoValue = std::numeric_limits<uint32_t>::max();

/// The state before the first view: half nowhere, half anywhere, at the rates' priors. Throws
/// Error(usage) for settings out of range. `least_change`: of a view, a frame distance.
FilterState start_filter(const FrameDistances& distances, const FilterSettings& settings,
                         double least_change);

/// Takes other places; all views are forgotten.
void place_filter(FilterState& state, FilterCells cells);

/// Forgets all views.
void restart_filter(FilterState& state);

/// Takes a view of the query: its standardized scores to all training frames, as
/// ScoreKernels::standardize writes them. Values, also that of being nowhere, are in units of
/// 1/1024 deviations, whole numbers; smaller is likelier. Time O(cells). Means nothing where there
/// are no places.
void advance_filter(FilterState& state, std::span<const uint16_t> scores);

}  // namespace vpr
