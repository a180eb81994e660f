// Compiled several times, once for each SIMD target: see Highway's foreach_target.h.
#include "base/highway.h"
// The settings above come first.
#include <cassert>
#include <limits>

#include "descriptors/nearest_centre.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "descriptors/nearest_centre.cpp"
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
constexpr size_t kPoints = 4;                                   // that share a loaded centre

using Floats = hn::Vec<Tag>;
using Indices = hn::Vec<IndexTag>;

// Points [0, Count) against all centres. Each lane keeps the first of its best; the lowest index
// among equal lanes wins at the end, so that the width of a vector does not matter.
template <size_t Count>
HWY_INLINE void Search(const CentreBlocks& centres, const float* const* points,
                       NearestCentre* nearest) {
  const Tag d;
  const IndexTag di;
  const size_t blocks = centres.half_norms.size() / kCentreLanes;
  for (size_t p = 0; p < Count; ++p)
    nearest[p] = {std::numeric_limits<float>::infinity(), std::numeric_limits<uint32_t>::max()};
  for (size_t lane = 0; lane < kCentreLanes; lane += kLanes * kVectors) {
    Floats best[Count][kVectors];
    Indices best_block[Count][kVectors];
    for (size_t p = 0; p < Count; ++p) {
      for (size_t v = 0; v < kVectors; ++v) {
        best[p][v] = hn::Set(d, std::numeric_limits<float>::infinity());
        best_block[p][v] = hn::Zero(di);
      }
    }
    for (size_t b = 0; b < blocks; ++b) {
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
          for (size_t v = 0; v < kVectors; ++v)
            sums[p][v] = hn::Add(sums[p][v], hn::Mul(x, centre[v]));
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
    for (size_t p = 0; p < Count; ++p) {
      for (size_t v = 0; v < kVectors; ++v) {
        float scores[kLanes];
        int32_t in_block[kLanes];
        hn::StoreU(best[p][v], d, scores);
        hn::StoreU(best_block[p][v], di, in_block);
        for (size_t l = 0; l < kLanes; ++l) {
          const auto index = static_cast<uint32_t>(static_cast<size_t>(in_block[l]) * kCentreLanes +
                                                   lane + v * kLanes + l);
          if (scores[l] < nearest[p].score ||
              (scores[l] == nearest[p].score && index < nearest[p].centre))
            nearest[p] = {scores[l], index};
        }
      }
    }
  }
}

void FindNearest(const CentreBlocks& centres, const MatrixView<const float>& points,
                 NearestCentre* nearest) {
  size_t row = 0;
  const float* rows[kPoints];
  for (; row + kPoints <= points.rows; row += kPoints) {
    for (size_t p = 0; p < kPoints; ++p) rows[p] = points.row(row + p).data();
    Search<kPoints>(centres, rows, nearest + row);
  }
  for (; row < points.rows; ++row) {
    rows[0] = points.row(row).data();
    Search<1>(centres, rows, nearest + row);
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

void find_nearest_centres(const CentreBlocks& centres, MatrixView<const float> points,
                          NearestCentre* nearest) {
  assert(centres.count > 0 && points.cols == centres.dims);
  HWY_DYNAMIC_DISPATCH(FindNearest)(centres, points, nearest);
}

}  // namespace vpr

#endif  // HWY_ONCE
