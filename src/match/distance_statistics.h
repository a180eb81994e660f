// Statistics of the distances between training frames.
#pragma once

#include "base/monitor.h"
#include "match/frame_distances.h"
#include "store/train_statistics.h"

namespace vpr {

/// What is assumed of training data too short to tell, as a share of the largest distance: about
/// what unrelated indoor frames give, 400 and 64 of LDB's 1386 bits.
constexpr double unknown_distance(uint16_t largest) { return 400 * reference_bit(largest); }
/// The standard deviation that goes with it.
constexpr double unknown_deviation(uint16_t largest) { return 64 * reference_bit(largest); }

/// Bias and variance of every training frame, over its distances to the sampled readable frames
/// that are not its neighbours. A frame with fewer than two of them has bias 0 and the mean
/// variance of the others; where that is every frame, variance and typical distance are those
/// unknown. Time O(frames * samples). Sums are integers: the same for any number of threads and any
/// SIMD target. Throws Error(usage) for settings out of range.
TrainStatistics compute_statistics(std::span<const DescriptorSpan> train,
                                   const StatisticsSettings& settings, const Monitor& monitor);

/// The frames that statistics compare with, rising: all readable ones if they are no more than
/// settings.samples, else one, drawn, of each of as many equal stretches.
std::vector<size_t> sampled_frames(std::span<const DescriptorSpan> train,
                                   const StatisticsSettings& settings);

}  // namespace vpr
