// The inner loops of standardized scores, compiled once for every SIMD target.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "store/train_statistics.h"

namespace vpr {

/// A standardized frame distance is kept as a whole number: (z + 32) * 1024, rounded to nearest, z
/// cut off at -32 and just below 32. A sum over a window is biased by 32 * 1024 a frame, stays
/// below 2^32 for windows of 65536 frames, and orders as the scores do.
inline constexpr uint32_t kScoreUnit = 1024;   ///< whole numbers a standard deviation
inline constexpr uint32_t kScoreBias = 32768;  ///< of z = 0

/// What is taken from the distances of a frame because of what training frames have in common
/// (components.h): for every training frame i, `unit` times the sum over all components of
/// common_product(loadings[k][i], weights[k]). Weights are within +-4095, so that all products
/// fit 16 bits. Nothing where there are no loadings.
struct CommonPart {
  std::array<const int8_t*, kMostComponents> loadings = {};
  std::array<int16_t, kMostComponents> weights = {};
  float unit = 0;
};

/// loading x weight / 128, rounded to the nearest, a half up.
constexpr int common_product(int8_t loading, int16_t weight) {
  return (loading * weight + 64) >> 7;
}

/// Running statistics are single-precision numbers, one operation after the other: additions,
/// multiplications, divisions and square roots, which IEEE rounds alike everywhere, and never a
/// fused one. All targets give the same bits.
struct ScoreKernels {
  /// d = ((distance - offset) - common part) - mean; mean += gain * d; variance = (1 - gain) *
  /// (variance + gain * d^2), for each of `count` training frames.
  void (*learn)(const uint16_t* distances, float offset, const CommonPart& common, float gain,
                float* mean, float* variance, size_t count);
  /// out = (((distance - offset) - common part) - mean) / sqrt(variance), variance within [least,
  /// most], as a whole number (see above). least > 0.
  void (*standardize)(const uint16_t* distances, float offset, const CommonPart& common,
                      const float* mean, const float* variance, float least_variance,
                      float most_variance, uint16_t* out, size_t count);
};

/// The kernels of the SIMD target in use (base/simd.h).
ScoreKernels select_score_kernels();

}  // namespace vpr
