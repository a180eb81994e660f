// Compiled once per SIMD target: see Highway's foreach_target.h.
#include "base/highway.h"
// The settings above must come first.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "fabmap/nearest_center.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fabmap/nearest_center.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vpr {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, kCenterLanes>;
using IndexTag = hn::RebindToSigned<Tag>;
constexpr size_t kLanes = hn::MaxLanes(Tag());
// vectors that share a broadcast point
constexpr size_t kVectors = kCenterLanes / kLanes < 2 ? 1 : 2;
constexpr size_t kPoints = 8;  // points that share a loaded center
// blocks of centers that stay in the cache while many points pass
constexpr size_t kTileBlocks = 16;

using Floats = hn::Vec<Tag>;
using Indices = hn::Vec<IndexTag>;

// a * b + c with a single rounding, even on targets without this instruction.
HWY_INLINE Floats FusedMulAdd(Floats a, Floats b, Floats c) {
#if HWY_NATIVE_FMA
  return hn::MulAdd(a, b, c);
#else
  const Tag d;
  float x[kLanes];
  float y[kLanes];
  float z[kLanes];
  hn::StoreU(a, d, x);
  hn::StoreU(b, d, y);
  hn::StoreU(c, d, z);
  for (size_t l = 0; l < kLanes; ++l) z[l] = std::fma(x[l], y[l], z[l]);
  return hn::LoadU(d, z);
#endif
}

// Merges the best of each lane into the best so far; the lowest index wins a tie, so that the width
// of a vector has no effect.
HWY_INLINE void MergeLanes(Floats best, Indices best_block, size_t first_lane,
                           NearestCenter& nearest) {
  float scores[kLanes];
  int32_t in_block[kLanes];
  hn::StoreU(best, Tag(), scores);
  hn::StoreU(best_block, IndexTag(), in_block);
  for (size_t l = 0; l < kLanes; ++l) {
    const auto index =
        static_cast<uint32_t>(static_cast<size_t>(in_block[l]) * kCenterLanes + first_lane + l);
    if (scores[l] < nearest.score || (scores[l] == nearest.score && index < nearest.center))
      nearest = {scores[l], index};
  }
}

// Compares `Count` points with the blocks [begin, end) of centers. Each lane keeps its first best.
template <size_t Count>
HWY_INLINE void Search(const CenterBlocks& centers, size_t begin, size_t end,
                       const float* const* points, NearestCenter* nearest) {
  const Tag d;
  const IndexTag di;
  for (size_t lane = 0; lane < kCenterLanes; lane += kLanes * kVectors) {
    Floats best[Count][kVectors];
    Indices best_block[Count][kVectors];
    for (size_t p = 0; p < Count; ++p) {
      for (size_t v = 0; v < kVectors; ++v) {
        best[p][v] = hn::Set(d, std::numeric_limits<float>::infinity());
        best_block[p][v] = hn::Zero(di);
      }
    }
    for (size_t b = begin; b < end; ++b) {
      const float* HWY_RESTRICT values =
          centers.values.data() + b * centers.dims * kCenterLanes + lane;
      Floats sums[Count][kVectors];
      for (size_t p = 0; p < Count; ++p)
        for (size_t v = 0; v < kVectors; ++v) sums[p][v] = hn::Zero(d);
      for (size_t k = 0; k < centers.dims; ++k, values += kCenterLanes) {
        Floats center[kVectors];
        for (size_t v = 0; v < kVectors; ++v) center[v] = hn::LoadU(d, values + v * kLanes);
        for (size_t p = 0; p < Count; ++p) {
          const Floats x = hn::Set(d, points[p][k]);
          for (size_t v = 0; v < kVectors; ++v) sums[p][v] = FusedMulAdd(x, center[v], sums[p][v]);
        }
      }
      for (size_t v = 0; v < kVectors; ++v) {
        const Floats norm =
            hn::LoadU(d, centers.half_norms.data() + b * kCenterLanes + lane + v * kLanes);
        for (size_t p = 0; p < Count; ++p) {
          const Floats score = hn::Sub(norm, sums[p][v]);
          const auto nearer = hn::Lt(score, best[p][v]);
          best[p][v] = hn::IfThenElse(nearer, score, best[p][v]);
          best_block[p][v] = hn::IfThenElse(hn::RebindMask(di, nearer),
                                            hn::Set(di, static_cast<int32_t>(b)), best_block[p][v]);
        }
      }
    }
    for (size_t p = 0; p < Count; ++p)
      for (size_t v = 0; v < kVectors; ++v)
        MergeLanes(best[p][v], best_block[p][v], lane + v * kLanes, nearest[p]);
  }
}

void FindNearest(const CenterBlocks& centers, const std::span<const float* const>& points,
                 NearestCenter* nearest) {
  const size_t blocks = centers.half_norms.size() / kCenterLanes;
  std::fill_n(nearest, points.size(), NearestCenter{std::numeric_limits<float>::infinity(), 0});
  for (size_t begin = 0; begin < blocks; begin += kTileBlocks) {
    const size_t end = std::min(blocks, begin + kTileBlocks);
    size_t p = 0;
    for (; p + kPoints <= points.size(); p += kPoints)
      Search<kPoints>(centers, begin, end, points.data() + p, nearest + p);
    for (; p < points.size(); ++p) Search<1>(centers, begin, end, points.data() + p, nearest + p);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace vpr
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace vpr {

HWY_EXPORT(FindNearest);

CenterBlocks make_center_blocks(MatrixView<const float> centers) {
  CenterBlocks blocks;
  blocks.count = centers.rows;
  blocks.dims = centers.cols;
  const size_t block_count = (centers.rows + kCenterLanes - 1) / kCenterLanes;
  blocks.values.assign(block_count * centers.cols * kCenterLanes, 0);
  blocks.half_norms.assign(block_count * kCenterLanes, std::numeric_limits<float>::infinity());
  for (size_t c = 0; c < centers.rows; ++c) {
    double norm = 0;
    for (size_t k = 0; k < centers.cols; ++k) {
      const float value = centers(c, k);
      blocks.values[(c / kCenterLanes * centers.cols + k) * kCenterLanes + c % kCenterLanes] =
          value;
      norm += static_cast<double>(value) * static_cast<double>(value);
    }
    blocks.half_norms[c] = static_cast<float>(norm / 2);
  }
  return blocks;
}

void find_nearest_centers(const CenterBlocks& centers, std::span<const float* const> points,
                          NearestCenter* nearest) {
  assert(centers.count > 0);
  HWY_DYNAMIC_DISPATCH(FindNearest)(centers, points, nearest);
}

}  // namespace vpr

#endif  // HWY_ONCE
