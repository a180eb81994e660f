// The principal components of training frames, which are subtracted from rows of distances.
#pragma once

#include <span>

#include "base/monitor.h"
#include "database/train_statistics.h"
#include "match/frame_distances.h"
#include "match/score_kernels.h"

namespace vpr {

inline constexpr size_t kMostLandmarks = 512;

/// The components of the readable frames of all sequences, by principal component analysis of the
/// distances of at most kMostLandmarks of them, with a fixed number of orthogonal iterations: the
/// same numbers on every machine and for any number of threads. Landmarks are spread evenly over
/// the keyframes, which differ from the previous ones by a quarter of the typical distance
/// (zscores.h), so that they do not depend on the walking speed. The subtracted share of a
/// component with eigenvalue w is w / (w + 15 t / n), where t is the sum of all eigenvalues and n
/// the number of landmarks: most of a strong component, and almost nothing of one that this number
/// of frames does not distinguish from noise. A component that does not exist has factor 0; none
/// exists if all frames are equal. Throws Error(interrupted) once the user wants to stop.
TrainComponents compute_components(std::span<const DescribedFrames> train, double typical_distance,
                                   const Monitor& monitor);

/// Components that subtract nothing.
TrainComponents no_components(size_t train_frames);

/// The projector for descriptors of the landmarks' shape.
Projector make_projector(const TrainComponents& components);

/// The components of a frame as used by the kernels: weights are rounded to nearest, ties up, and
/// clamped at 512 bits of LDB (other distances: the same share of the largest one).
using ComponentWeights = std::array<int16_t, kMaxComponents>;
ComponentWeights component_weights(const TrainComponents& components,
                                   const ComponentValues& of_frame);

/// The amount that is subtracted from a frame's distance to a training frame, in component_unit().
int component_sum(const TrainComponents& components, const ComponentWeights& weights,
                  size_t train_frame);

/// An eighth of a bit of LDB, or the same share of another largest distance.
double component_unit(const DescriptorShape& shape);

}  // namespace vpr
