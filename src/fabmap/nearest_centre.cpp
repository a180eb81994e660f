// Compiled several times, once for each SIMD target: see Highway's foreach_target.h.
#include "base/highway.h"
// The settings above come first.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "fabmap/nearest_centre.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fabmap/nearest_centre.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vpr {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, kCentreLanes>;
using IndexTag = hn::RebindToSigned<Tag>;
constexpr size_t kLanes = hn::MaxLanes(Tag());
constexpr size_t kVectors = kCentreLanes / kLanes < 2 ? 1 : 2;  // that share a broadcast point
constexpr size_t kPoints = 8;                                   // that share a loaded centre
constexpr size_t kTileBlocks = 16;  // of centres that stay in the cache while many points pass

using Floats = hn::Vec<Tag>;
using Indices = hn::Vec<IndexTag>;

// a * b + c, rounded once, also where the target has no such instruction.
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

// Takes the better of the best so far and each lane's; the lowest index among equals wins, so that
// the width of a vector does not matter.
HWY_INLINE void MergeLanes(Floats best, Indices best_block, size_t first_lane,
                           NearestCentre& nearest) {
  float scores[kLanes];
  int32_t in_block[kLanes];
  hn::StoreU(best, Tag(), scores);
  hn::StoreU(best_block, IndexTag(), in_block);
  for (size_t l = 0; l < kLanes; ++l) {
    const auto index =
        static_cast<uint32_t>(static_cast<size_t>(in_block[l]) * kCentreLanes + first_lane + l);
    if (scores[l] < nearest.score || (scores[l] == nearest.score && index < nearest.centre))
      nearest = {scores[l], index};
  }
}

// `Count` points against the blocks [begin, end) of centres. Each lane keeps the first of its best.
template <size_t Count>
HWY_INLINE void Search(const CentreBlocks& centres, size_t begin, size_t end,
                       const float* const* points, NearestCentre* nearest) {
  const Tag d;
  const IndexTag di;
  for (size_t lane = 0; lane < kCentreLanes; lane += kLanes * kVectors) {
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
          centres.values.data() + b * centres.dims * kCentreLanes + lane;
      Floats sums[Count][kVectors];
      for (size_t p = 0; p < Count; ++p)
        for (size_t v = 0; v < kVectors; ++v) sums[p][v] = hn::Zero(d);
      for (size_t k = 0; k < centres.dims; ++k, values += kCentreLanes) {
        Floats centre[kVectors];
        for (size_t v = 0; v < kVectors; ++v) centre[v] = hn::LoadU(d, values + v * kLanes);
        for (size_t p = 0; p < Count; ++p) {
          const Floats x = hn::Set(d, points[p][k]);
          for (size_t v = 0; v < kVectors; ++v) sums[p][v] = FusedMulAdd(x, centre[v], sums[p][v]);
        }
      }
      for (size_t v = 0; v < kVectors; ++v) {
        const Floats norm =
            hn::LoadU(d, centres.half_norms.data() + b * kCentreLanes + lane + v * kLanes);
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

void FindNearest(const CentreBlocks& centres, const std::span<const float* const>& points,
                 NearestCentre* nearest) {
  const size_t blocks = centres.half_norms.size() / kCentreLanes;
  std::fill_n(nearest, points.size(), NearestCentre{std::numeric_limits<float>::infinity(), 0});
  for (size_t begin = 0; begin < blocks; begin += kTileBlocks) {
    const size_t end = std::min(blocks, begin + kTileBlocks);
    size_t p = 0;
    for (; p + kPoints <= points.size(); p += kPoints)
      Search<kPoints>(centres, begin, end, points.data() + p, nearest + p);
    for (; p < points.size(); ++p) Search<1>(centres, begin, end, points.data() + p, nearest + p);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace vpr
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace vpr {

HWY_EXPORT(FindNearest);

CentreBlocks make_centre_blocks(MatrixView<const float> centres) {
  CentreBlocks blocks;
  blocks.count = centres.rows;
  blocks.dims = centres.cols;
  const size_t block_count = (centres.rows + kCentreLanes - 1) / kCentreLanes;
  blocks.values.assign(block_count * centres.cols * kCentreLanes, 0);
  blocks.half_norms.assign(block_count * kCentreLanes, std::numeric_limits<float>::infinity());
  for (size_t c = 0; c < centres.rows; ++c) {
    double norm = 0;
    for (size_t k = 0; k < centres.cols; ++k) {
      const float value = centres(c, k);
      blocks.values[(c / kCentreLanes * centres.cols + k) * kCentreLanes + c % kCentreLanes] =
          value;
      norm += static_cast<double>(value) * static_cast<double>(value);
    }
    blocks.half_norms[c] = static_cast<float>(norm / 2);
  }
  return blocks;
}

void find_nearest_centres(const CentreBlocks& centres, std::span<const float* const> points,
                          NearestCentre* nearest) {
  assert(centres.count > 0);
  HWY_DYNAMIC_DISPATCH(FindNearest)(centres, points, nearest);
}

}  // namespace vpr

#endif  // HWY_ONCE
