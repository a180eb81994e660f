// Statistics of the distances between training frames.
#pragma once

#include "base/monitor.h"
#include "database/train_statistics.h"
#include "match/frame_distances.h"

namespace vpr {

/// The typical distance that is assumed if the training data are too short: about the distance of
/// unrelated indoor frames, 400 of LDB's 1386 bits, or the same share of another largest distance.
constexpr double unknown_distance(uint16_t largest) { return 400 * reference_bit(largest); }
/// The corresponding standard deviation, 64 bits for LDB.
constexpr double unknown_deviation(uint16_t largest) { return 64 * reference_bit(largest); }

/// Bias and variance of every training frame over its distances to the sampled readable frames that
/// are not its neighbors. A frame with fewer than two of them has bias 0 and the mean variance of
/// the others; without others, variance and typical distance are those assumed for unknown data.
/// Time O(frames * samples). Sums are integers: the same for any number of threads and any SIMD
/// target. Throws Error(usage) for settings out of range.
TrainStatistics compute_statistics(std::span<const DescribedFrames> train,
                                   const StatisticsSettings& settings, const Monitor& monitor);

/// The frames used as samples, increasing: all readable ones if there are at most settings.samples,
/// otherwise one randomly chosen frame from each of settings.samples equal parts, or, of sets of
/// more than 10 000 frames, of 10^8 / frames parts, but at least 2000.
std::vector<size_t> sampled_frames(std::span<const DescribedFrames> train,
                                   const StatisticsSettings& settings);

}  // namespace vpr
