// Statistics of the distances between training frames.
#pragma once

#include "base/monitor.h"
#include "database/train_statistics.h"
#include "matching/codes.h"
#include "matching/hamming_kernels.h"

namespace vpr {

/// What is assumed of training data too short to tell, in bits: about what unrelated indoor frames
/// give.
inline constexpr double kUnknownDistance = 400;
inline constexpr double kUnknownDeviation = 64;

/// Bias and variance of every frame of `train`, over its distances to the sampled readable frames
/// that are not its neighbours. A frame with fewer than two of them has bias 0 and the mean
/// variance of the others; where that is every frame, variance and typical distance are those
/// unknown. Time O(frames * samples). Sums are integers: the same for any number of threads and any
/// SIMD target. Throws Error(usage) for settings out of range.
TrainStatistics compute_statistics(const TrainCodes& train, const StatisticsSettings& settings,
                                   const HammingKernels& kernels, const Monitor& monitor);

/// The frames that statistics compare with, rising: all readable ones if they are no more than
/// settings.samples, else one, drawn, of each of as many equal stretches.
std::vector<size_t> sampled_frames(const TrainCodes& train, const StatisticsSettings& settings);

}  // namespace vpr
