// The centre that is nearest to a point: exact, and the same on every SIMD target.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/matrix_view.h"

namespace vpr {

/// Centres of a block of CentreBlocks.
inline constexpr size_t kCentreLanes = 32;

/// Centres in blocks of 32, dimension by dimension, so that a SIMD lane is a centre.
struct CentreBlocks {
  size_t count = 0;
  size_t dims = 0;
  std::vector<float> values;      ///< block, dimension, lane
  std::vector<float> half_norms;  ///< |c|^2 / 2; infinite in the padding
};

/// The blocks of centres, one a row; the last block is filled up with centres that are infinitely
/// far.
CentreBlocks make_centre_blocks(MatrixView<const float> centres);

/// |p - c|^2 / 2 - |p|^2 / 2 of the nearest centre c of point p: smaller is nearer.
struct NearestCentre {
  float score = 0;
  uint32_t centre = 0;
};

/// One entry a point; `points` holds the address of each point's centres.dims values. Ties go to
/// the lower index. A score is one chain of fused multiply-adds over the dimensions in order,
/// rounded as IEEE says on every target: it depends on the point and the centre alone. A point that
/// is not a number gets centre 0. `centres` must not be empty.
void find_nearest_centres(const CentreBlocks& centres, std::span<const float* const> points,
                          NearestCentre* nearest);

}  // namespace vpr
