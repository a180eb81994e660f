// Compiled once per SIMD target: see Highway's foreach_target.h.
#include "fabmap/vocabulary.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>

#include <opencv2/core/hal/hal.hpp>
#include <opencv2/core/mat.hpp>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "fabmap/vocabulary.cpp"
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

namespace {

// The last block is padded with infinitely distant centers.
CenterBlocks make_center_blocks(const cv::Mat& centers) {
  CenterBlocks blocks;
  const auto count = static_cast<size_t>(centers.rows);
  blocks.dims = static_cast<size_t>(centers.cols);
  const size_t block_count = (count + kCenterLanes - 1) / kCenterLanes;
  blocks.values.assign(block_count * blocks.dims * kCenterLanes, 0);
  blocks.half_norms.assign(block_count * kCenterLanes, std::numeric_limits<float>::infinity());
  for (size_t c = 0; c < count; ++c) {
    const auto* center = centers.ptr<float>(static_cast<int>(c));
    double norm = 0;
    for (size_t k = 0; k < blocks.dims; ++k) {
      blocks.values[(c / kCenterLanes * blocks.dims + k) * kCenterLanes + c % kCenterLanes] =
          center[k];
      norm += static_cast<double>(center[k]) * static_cast<double>(center[k]);
    }
    blocks.half_norms[c] = static_cast<float>(norm / 2);
  }
  return blocks;
}

}  // namespace

Vocabulary make_vocabulary(const cv::Mat& words) {
  assert(words.rows > 0);
  Vocabulary vocabulary{words, {}};
  if (words.type() == CV_32F) vocabulary.blocks = make_center_blocks(words);
  return vocabulary;
}

std::vector<NearestCenter> find_nearest_words(const Vocabulary& vocabulary,
                                              const cv::Mat& descriptors,
                                              std::span<const uint32_t> rows) {
  assert(descriptors.type() == vocabulary.words.type());
  assert(descriptors.cols == vocabulary.words.cols);
  std::vector<NearestCenter> nearest;
  if (descriptors.type() == CV_32F) {
    std::vector<const float*> points;
    for (const uint32_t row : rows) points.push_back(descriptors.ptr<float>(static_cast<int>(row)));
    nearest.resize(rows.size());
    HWY_DYNAMIC_DISPATCH(FindNearest)(vocabulary.blocks, points, nearest.data());
  } else {
    const cv::Mat& words = vocabulary.words;
    for (const uint32_t row : rows) {
      const uint8_t* const descriptor = descriptors.ptr(static_cast<int>(row));
      NearestCenter best{std::numeric_limits<float>::infinity(), 0};
      for (int w = 0; w < words.rows; ++w) {
        const auto distance =
            static_cast<float>(cv::hal::normHamming(words.ptr(w), descriptor, words.cols));
        if (distance < best.score) best = {distance, static_cast<uint32_t>(w)};
      }
      nearest.push_back(best);
    }
  }
  return nearest;
}

std::vector<uint32_t> nearest_words(const Vocabulary& vocabulary, const cv::Mat& descriptors) {
  std::vector<uint32_t> words(static_cast<size_t>(descriptors.rows));
  std::iota(words.begin(), words.end(), 0U);
  const std::vector<NearestCenter> nearest = find_nearest_words(vocabulary, descriptors, words);
  std::ranges::transform(nearest, words.begin(), &NearestCenter::center);
  return words;
}

WordSet quantize(const Vocabulary& vocabulary, const cv::Mat& descriptors) {
  WordSet words = nearest_words(vocabulary, descriptors);
  std::sort(words.begin(), words.end());
  words.erase(std::unique(words.begin(), words.end()), words.end());
  return words;
}

WordIndex make_word_index(const ViewWords& views, size_t words) {
  WordIndex index;
  index.words = words;
  index.views = views.views();
  index.offsets.assign(index.blocks() * words + 1, 0);
  const auto for_each = [&](auto&& visit) {
    for (size_t v = 0; v < index.views; ++v)
      for (const uint32_t word : views.view(v)) visit(v / kIndexBlock * words + word, v);
  };
  for_each([&](size_t list, size_t) { ++index.offsets[list + 1]; });
  std::partial_sum(index.offsets.begin(), index.offsets.end(), index.offsets.begin());
  index.lists.resize(views.words.size());
  std::vector<uint64_t> at(index.offsets.begin(), index.offsets.end() - 1);
  for_each([&](size_t list, size_t v) {
    index.lists[at[list]++] = static_cast<uint16_t>(v % kIndexBlock);
  });
  return index;
}

bool is_valid_index(const WordIndex& index) {
  if (index.offsets.size() != index.blocks() * index.words + 1 || index.offsets.front() != 0 ||
      index.offsets.back() != index.lists.size() ||
      !std::is_sorted(index.offsets.begin(), index.offsets.end()))
    return false;
  for (size_t block = 0; block < index.blocks(); ++block) {
    for (size_t word = 0; word < index.words; ++word) {
      const auto list = index.list(block, word);
      if (!list.empty() &&
          (list.back() >= index.views - block * kIndexBlock ||
           std::adjacent_find(list.begin(), list.end(), std::greater_equal<>()) != list.end()))
        return false;
    }
  }
  return true;
}

}  // namespace vpr

#endif  // HWY_ONCE
