// The inner loops of standardized scores, compiled once for every SIMD target.
#pragma once

#include <cstddef>
#include <cstdint>

namespace vpr {

/// A standardized frame distance is kept as a whole number: (z + 32) * 1024, rounded to nearest, z
/// cut off at -32 and just below 32. A sum over a window is biased by 32 * 1024 a frame, stays
/// below 2^32 for windows of 65536 frames, and orders as the scores do.
inline constexpr uint32_t kScoreUnit = 1024;   ///< whole numbers a standard deviation
inline constexpr uint32_t kScoreBias = 32768;  ///< of z = 0

/// Running statistics are single-precision numbers, one operation after the other: additions,
/// multiplications, divisions and square roots, which IEEE rounds alike everywhere, and never a
/// fused one. All targets give the same bits.
struct ScoreKernels {
  /// d = (distance - offset) - mean; mean += gain * d; variance = (1 - gain) * (variance + gain *
  /// d^2), for each of `count` training frames.
  void (*learn)(const uint16_t* distances, float offset, float gain, float* mean, float* variance,
                size_t count);
  /// out = ((distance - offset) - mean) / sqrt(variance), variance within [least, most], as a whole
  /// number (see above). least > 0.
  void (*standardize)(const uint16_t* distances, float offset, const float* mean,
                      const float* variance, float least_variance, float most_variance,
                      uint16_t* out, size_t count);
};

/// The kernels of the SIMD target in use (base/simd.h).
ScoreKernels select_score_kernels();

}  // namespace vpr
