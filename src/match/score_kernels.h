// The inner loops of z-scores, compiled once per SIMD target.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "database/train_statistics.h"

namespace vpr {

/// A frame's z-score is stored as an integer: (z + 32) * 1024, rounded to nearest, with z clamped
/// to -32 and just below 32. A sum over a window has a bias of 32 * 1024 per frame, stays below
/// 2^32 for windows of 65536 frames, and has the order of the scores.
inline constexpr uint32_t kScoreUnit = 1024;   ///< integers per standard deviation
inline constexpr uint32_t kScoreBias = 32768;  ///< of z = 0

/// The amount subtracted from the distances of a frame because of components (components.h): for
/// every training frame i, `unit` times the sum over all components of
/// component_product(loadings[k][i], weights[k]). Weights are within +-4095, so that all products
/// fit 16 bits. Nothing is subtracted without loadings.
struct ComponentTerm {
  std::array<const int8_t*, kMaxComponents> loadings = {};
  std::array<int16_t, kMaxComponents> weights = {};
  float unit = 0;
};

/// loading x weight / 128, rounded to nearest, ties up.
constexpr int component_product(int8_t loading, int16_t weight) {
  return (loading * weight + 64) >> 7;
}

/// Running statistics are in single precision. Additions, multiplications, divisions and square
/// roots are never fused, and IEEE 754 rounds them the same way everywhere: all targets give the
/// same bits.
struct ScoreKernels {
  /// d = ((distance - offset) - common part) - mean; mean += gain * d; variance = (1 - gain) *
  /// (variance + gain * d^2), for each of `count` training frames.
  void (*learn)(const uint16_t* distances, float offset, const ComponentTerm& common, float gain,
                float* mean, float* variance, size_t count);
  /// out = (((distance - offset) - common part) - mean) / sqrt(variance), with a variance of at
  /// least least_variance, which is above 0, as an integer (see above).
  void (*to_zscores)(const uint16_t* distances, float offset, const ComponentTerm& common,
                     const float* mean, const float* variance, float least_variance, uint16_t* out,
                     size_t count);
};

/// The kernels for the current SIMD target (base/simd.h).
ScoreKernels select_score_kernels();

}  // namespace vpr
