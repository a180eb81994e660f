// The inner loop of the filter over places and rates, compiled once per SIMD target.
#pragma once

#include <array>
#include <cstddef>

namespace vpr {

/// Training keyframes per query keyframe: 0, 1/2, 2/3, 1, 3/2, 2.
inline constexpr size_t kRates = 6;

/// The number of steps of a rate, beginning with the shortest one.
inline constexpr size_t kSteps = 3;
inline constexpr std::array<size_t, kRates> kFirstSteps = {0, 0, 0, 0, 1, 1};

/// One array per rate, all of the length of the cells.
using RateArrays = std::array<float*, kRates>;
using ConstRateArrays = std::array<const float*, kRates>;

/// The constants of one step, equal for all cells.
struct FilterStep {
  /// By rate and step: its probability, times the normalization of masses.
  std::array<std::array<float, kSteps>, kRates> weights;
  std::array<float, kRates> entering;  ///< mass of the paths that begin at each cell
  std::array<float, kRates> change;    ///< share of a cell's mass that changes to the rate
  float stay = 0;                      ///< share of a rate's mass that stays with it
};

struct FilterKernels {
  /// For cells [first, first + count) and every rate r, with s = kFirstSteps[r]:
  ///   new(r) = likelihood * (((w0 * before(cell - s) + w1 * before(cell - s - 1)) +
  ///            w2 * before(cell - s - 2)) + entering)
  /// mass = the sum of new(r), in the order of rates, and after(r) = stay * new(r) + change * mass.
  /// Single operations, never fused: all targets give the same bits. Reads the kLongestStep cells
  /// before `first`; arrays must not overlap.
  void (*step)(const FilterStep& step, const float* likelihoods, const ConstRateArrays& before,
               const RateArrays& after, float* masses, size_t first, size_t count);
};

/// The kernels for the current SIMD target (base/simd.h).
FilterKernels select_filter_kernels();

}  // namespace vpr
