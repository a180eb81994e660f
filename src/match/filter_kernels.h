// The inner loop of the filter over places and rates, compiled once for every SIMD target.
#pragma once

#include <array>
#include <cstddef>

namespace vpr {

/// Training views a query view: 0, 1/2, 2/3, 1, 3/2, 2.
inline constexpr size_t kRates = 6;

/// A step of a rate is one of so many, from the shortest on.
inline constexpr size_t kSteps = 3;
inline constexpr std::array<size_t, kRates> kFirstSteps = {0, 0, 0, 0, 1, 1};

/// One array a rate, all of them as long as there are cells.
using RateArrays = std::array<float*, kRates>;
using ConstRateArrays = std::array<const float*, kRates>;

/// The numbers of one step, alike for all cells.
struct FilterStep {
  /// Of a rate and a step: how likely it is, times what masses are normalised by.
  std::array<std::array<float, kSteps>, kRates> weights;
  std::array<float, kRates> born;    ///< what comes to each cell from anywhere
  std::array<float, kRates> change;  ///< share of a cell's mass that turns to the rate
  float stay = 0;                    ///< share of a rate's mass that stays with it
};

struct FilterKernels {
  /// For cells [first, first + count) and every rate r, with s = kFirstSteps[r]:
  ///   new(r) = likelihood * (((w0 * before(cell - s) + w1 * before(cell - s - 1)) +
  ///            w2 * before(cell - s - 2)) + born)
  /// mass = the sum of new(r), in the order of rates, and after(r) = stay * new(r) + change * mass.
  /// One operation after the other, never fused: all targets give the same bits. The kLongestStep
  /// cells in front of `first` are read, and no array overlaps another.
  void (*step)(const FilterStep& step, const float* likelihoods, const ConstRateArrays& before,
               const RateArrays& after, float* masses, size_t first, size_t count);
};

/// The kernels of the SIMD target in use (base/simd.h).
FilterKernels select_filter_kernels();

}  // namespace vpr
