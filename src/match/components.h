// The principal components of training frames: how they are found, and what is taken from a row of
// distances because of them.
#pragma once

#include <span>

#include "base/monitor.h"
#include "match/frame_distances.h"
#include "match/score_kernels.h"
#include "store/train_statistics.h"

namespace vpr {

inline constexpr size_t kMostLandmarks = 512;

/// The components of the readable frames of all sequences, by principal component analysis of the
/// distances of at most kMostLandmarks of them, after a fixed number of orthogonal iterations: the
/// same numbers on every machine and for any number of threads. Landmarks are spread evenly over
/// the views, frames that differ from the last ones by a quarter of the typical distance
/// (standardization.h), so that they do not depend on how slowly somebody walked. What is taken
/// away of a component of eigenvalue w is the share w / (w + 15 t / n), with t the sum of all
/// eigenvalues and n that of the landmarks: much of a strong component, and next to nothing of one
/// that so few frames do not tell from chance. A component that the frames do not have has factor
/// 0, as all have where there are no two different frames. Throws Error(interrupted) once the user
/// wants to stop.
TrainComponents compute_components(std::span<const DescriptorSpan> train, double typical_distance,
                                   const Monitor& monitor);

/// Such that nothing is taken away.
TrainComponents no_components(size_t train_frames);

/// Of any descriptor of the landmarks' shape.
Projector make_projector(const TrainComponents& components);

/// The first `count` components of a frame, as kernels take them away: weights round to the
/// nearest, a half up, and are cut off at 512 bits of LDB (other distances: the same share of the
/// largest).
using CommonWeights = std::array<int16_t, kMostComponents>;
CommonWeights common_weights(const TrainComponents& components, size_t count,
                             const ComponentValues& of_frame);

/// What is taken from a frame's distance to a training frame, in units of common_unit().
int common_sum(const TrainComponents& components, const CommonWeights& weights, size_t train_frame);

/// An eighth of a bit of LDB, or the same share of another largest distance.
double common_unit(const DescriptorShape& shape);

}  // namespace vpr
