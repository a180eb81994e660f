// Mean absolute differences of images. Compiled once per SIMD target: see Highway's
// foreach_target.h.
#include <algorithm>
#include <array>
#include <cassert>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <numeric>

#include "match/frame_distances.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "match/gray_distances.cpp"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace vpr {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

constexpr size_t kVectorPixels = 64;  // at most

#if HWY_TARGET == HWY_SCALAR  // one lane, without bytes

uint32_t Differences(const uint8_t* a, const uint8_t* b, size_t length) {
  uint32_t sum = 0;
  for (size_t i = 0; i < length; ++i) sum += static_cast<uint32_t>(std::abs(a[i] - b[i]));
  return sum;
}

#else

HWY_INLINE uint32_t Differences(const uint8_t* HWY_RESTRICT a, const uint8_t* HWY_RESTRICT b,
                                size_t length) {
  const hn::CappedTag<uint8_t, kVectorPixels> d;
  const hn::Repartition<uint64_t, decltype(d)> d64;
  auto sums = hn::Zero(d64);
  for (size_t i = 0; i < length; i += hn::Lanes(d)) {
    const auto left = hn::LoadU(d, a + i);
    const auto right = hn::LoadU(d, b + i);
    sums = hn::Add(sums, hn::SumsOf8(hn::Sub(hn::Max(left, right), hn::Min(left, right))));
  }
  return static_cast<uint32_t>(hn::GetLane(hn::SumOfLanes(d64, sums)));
}

#endif

// out[t * row_count + i] = the sum of absolute differences of queries[t] and row i, for consecutive
// rows of `length` (padded) pixels. A row stays in the nearest cache for all query frames.
void Tile(std::span<const uint8_t* const> queries, const uint8_t* rows, size_t row_count,
          size_t length, uint32_t* out) {
  for (size_t i = 0; i < row_count; ++i)
    for (size_t t = 0; t < queries.size(); ++t)
      out[t * row_count + i] = Differences(queries[t], rows + i * length, length);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace vpr
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace vpr {

HWY_EXPORT(Tile);

namespace {

constexpr size_t kPadding = 64;  // images are padded with zeros to a multiple of this size
constexpr size_t kLevels = 256;
constexpr uint64_t kUnits = 256;  // per gray level
constexpr size_t kPart = 64;      // training frames whose differences are buffered

// The mean over `pixels` pixels, rounded to the nearest unit, ties up.
uint64_t rounded_mean(uint64_t sum, size_t pixels) {
  return (2 * kUnits * sum + pixels) / (2 * pixels);
}

/// The contribution of one pixel to a sum over descriptors, by its level.
template <class T>
using OfLevel = std::array<T, kLevels>;

// For each level v, the sum over levels u of weights[u] |v - u|.
template <class T>
OfLevel<T> differences_to(const OfLevel<T>& weights) {
  OfLevel<T> sums = {};
  for (size_t u = 1; u < kLevels; ++u) sums[0] += weights[u] * static_cast<T>(u);
  T below = {};
  T above = std::accumulate(weights.begin(), weights.end(), T{});
  for (size_t v = 1; v < kLevels; ++v) {  // one level higher: nearer to the higher levels
    below += weights[v - 1];
    above -= weights[v - 1];
    sums[v] = sums[v - 1] + below - above;
  }
  return sums;
}

/// Training frames in the format of the kernel.
struct Training {
  std::vector<DescribedFrames> sequences;
  size_t length = 0;
  size_t padded_length = 0;
  std::vector<uint8_t> rows;  ///< padded
  std::once_flag has_totals;
  /// Over all readable frames, by pixel; computed on first use.
  std::vector<OfLevel<int64_t>> totals;
};

void append_padded(std::vector<uint8_t>& images, const DescriptorRows& rows, size_t padded_length) {
  images.reserve(images.size() + rows.size() * padded_length);
  for (size_t i = 0; i < rows.size(); ++i) {
    images.insert(images.end(), rows[i].begin(), rows[i].end());
    images.resize(images.size() + padded_length - rows[i].size(), 0);
  }
}

void fill_tile(const Training& training, const std::vector<uint8_t>& images,
               std::span<const uint32_t> queries, size_t first, size_t last, uint16_t* out,
               size_t stride) {
  assert(first % kBlockFrames == 0);
  std::vector<const uint8_t*> vectors;
  for (const uint32_t frame : queries)
    vectors.push_back(images.data() + frame * training.padded_length);
  std::vector<uint32_t> sums(queries.size() * kPart);
  for (size_t part = first; part < last; part += kPart) {
    const size_t count = std::min(kPart, last - part);
    HWY_DYNAMIC_DISPATCH(Tile)
    (vectors, training.rows.data() + part * training.padded_length, count, training.padded_length,
     sums.data());
    for (size_t t = 0; t < queries.size(); ++t)
      for (size_t i = 0; i < count; ++i)
        out[t * stride + (part - first) + i] =
            static_cast<uint16_t>(rounded_mean(sums[t * count + i], training.length));
  }
}

uint64_t row_total(Training& training, DescriptorRow row) {
  std::call_once(training.has_totals, [&] {
    training.totals.resize(training.length, OfLevel<int64_t>{});
    for (const FrameStretch& run : readable_runs(training.sequences))
      for (size_t i = 0; i < run.count; ++i) {
        const DescriptorRow image =
            training.sequences[run.sequence].rows[run.first_in_sequence + i];
        for (size_t x = 0; x < image.size(); ++x) ++training.totals[x][image[x]];
      }
    for (OfLevel<int64_t>& pixel : training.totals) pixel = differences_to(pixel);
  });
  uint64_t sum = 0;
  for (size_t x = 0; x < row.size(); ++x) sum += static_cast<uint64_t>(training.totals[x][row[x]]);
  return rounded_mean(sum, training.length);
}

PreparedTraining prepare(std::span<const DescribedFrames> train, const DescriptorShape& shape) {
  const auto training = std::make_shared<Training>();
  training->sequences.assign(train.begin(), train.end());
  training->length = shape.length;
  training->padded_length = round_up(shape.length, kPadding);
  for (const DescribedFrames& sequence : train)
    append_padded(training->rows, sequence.rows, training->padded_length);
  return [training](FrameDistances& distances) {
    const auto images = std::make_shared<std::vector<uint8_t>>();
    append_padded(*images, distances.query.rows, training->padded_length);
    distances.tile = [training, images](std::span<const uint32_t> queries, size_t first,
                                        size_t last, uint16_t* out, size_t stride) {
      fill_tile(*training, *images, queries, first, last, out, stride);
    };
    distances.row_total = [training, rows = distances.query.rows](size_t query) {
      return row_total(*training, rows[query]);
    };
  };
}

uint32_t gray_distance(DescriptorRow a, DescriptorRow b) {
  uint64_t sum = 0;
  for (size_t x = 0; x < a.size(); ++x) sum += static_cast<uint64_t>(std::abs(a[x] - b[x]));
  return static_cast<uint32_t>(rounded_mean(sum, a.size()));
}

// Weights are multiples of 2^-20, so their sums are exact in any order.
Projector make_projector(const DescriptorRows& to, std::span<const ComponentValues> weights) {
  const size_t length = to.shape.length;
  std::vector<OfLevel<ComponentValues>> sums(length);
  for (size_t x = 0; x < length; ++x) {
    for (size_t k = 0; k < kMaxComponents; ++k) {
      OfLevel<double> of_level = {};
      for (size_t i = 0; i < to.size(); ++i) of_level[to[i][x]] += weights[i][k];
      of_level = differences_to(of_level);
      for (size_t v = 0; v < kLevels; ++v) sums[x][v][k] = of_level[v];
    }
  }
  return [sums = std::move(sums), length](DescriptorRow row) {
    ComponentValues values = {};
    for (size_t x = 0; x < length; ++x)
      for (size_t k = 0; k < kMaxComponents; ++k) values[k] += sums[x][row[x]][k];
    for (double& value : values) value *= static_cast<double>(kUnits) / static_cast<double>(length);
    return values;
  };
}

}  // namespace

const DistanceKind kGrayDistance = {
    ElementType::gray_levels,
    {"256ths of a gray level", 1.0 / 256},
    [](const DescriptorShape&) -> uint16_t { return (kLevels - 1) * kUnits; },
    gray_distance,
    make_projector,
    prepare};

}  // namespace vpr

#endif  // HWY_ONCE
