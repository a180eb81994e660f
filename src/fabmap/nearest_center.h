// Finds the nearest center of a point: exact, and the same on every SIMD target.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/matrix_view.h"

namespace vpr {

/// Centers per block of CenterBlocks.
inline constexpr size_t kCenterLanes = 32;

/// Centers in blocks of 32, stored by dimension, so that each SIMD lane is one center.
struct CenterBlocks {
  size_t count = 0;
  size_t dims = 0;
  std::vector<float> values;      ///< by block, dimension, lane
  std::vector<float> half_norms;  ///< |c|^2 / 2; infinite in the padding
};

/// The blocks of centers, given one per row; the last block is padded with infinitely distant
/// centers.
CenterBlocks make_center_blocks(MatrixView<const float> centers);

/// |p - c|^2 / 2 - |p|^2 / 2 of the nearest center c of point p: smaller is nearer.
struct NearestCenter {
  float score = 0;
  uint32_t center = 0;
};

/// One entry per point; `points` holds the address of each point's centers.dims values. Ties go to
/// the lower index. A score is a chain of fused multiply-adds over the dimensions in order, rounded
/// according to IEEE 754 on every target, so it depends only on the point and the center. A point
/// with a NaN gets center 0. `centers` must not be empty.
void find_nearest_centers(const CenterBlocks& centers, std::span<const float* const> points,
                          NearestCenter* nearest);

}  // namespace vpr
