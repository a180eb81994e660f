#include <algorithm>
#include <array>
#include <cassert>
#include <memory>
#include <mutex>
#include <numeric>

#include <fmt/format.h>

#include "base/error.h"
#include "match/frame_distances.h"
#include "match/gray_kernels.h"

namespace vpr {
namespace {

constexpr size_t kLevels = 256;
constexpr uint64_t kUnits = 256;  // per gray level
constexpr size_t kPart = 64;      // training frames whose differences are buffered

size_t round_up(size_t value, size_t multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

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

/// The common data of distances to the same training frames. Images are padded.
struct Training {
  std::vector<DescriptorSpan> sequences;
  GrayKernels kernels;
  size_t length = 0;
  size_t padded_length = 0;
  std::vector<uint8_t> rows;
  std::once_flag has_totals;
  /// Over all readable frames, by pixel; computed on first use.
  std::vector<OfLevel<int64_t>> totals;
};

std::vector<uint8_t> padded(const DescriptorRows& rows, size_t padded_length) {
  std::vector<uint8_t> all(rows.size() * padded_length, 0);
  for (size_t i = 0; i < rows.size(); ++i)
    std::copy(rows[i].begin(), rows[i].end(), all.begin() + ptrdiff_t(i * padded_length));
  return all;
}

std::vector<OfLevel<int64_t>> sum_differences(std::span<const DescriptorSpan> sequences,
                                              size_t length) {
  std::vector<OfLevel<int64_t>> sums(length, OfLevel<int64_t>{});
  for (const DescriptorSpan& sequence : sequences)
    for (const FrameRun& run : readable_runs(sequence))
      for (size_t i = run.first; i < run.first + run.count; ++i)
        for (size_t x = 0; x < length; ++x) ++sums[x][sequence.rows[i][x]];
  for (OfLevel<int64_t>& pixel : sums) pixel = differences_to(pixel);
  return sums;
}

void fill_tile(const Training& training, const std::vector<uint8_t>& pictures,
               std::span<const uint32_t> queries, size_t first, size_t last, uint16_t* out,
               size_t stride) {
  assert(first % kStretchFrames == 0);
  std::vector<const uint8_t*> vectors;
  for (const uint32_t frame : queries)
    vectors.push_back(pictures.data() + frame * training.padded_length);
  std::vector<uint32_t> sums(queries.size() * kPart);
  for (size_t part = first; part < last; part += kPart) {
    const size_t count = std::min(kPart, last - part);
    training.kernels.tile(vectors, training.rows.data() + part * training.padded_length, count,
                          training.padded_length, sums.data());
    for (size_t t = 0; t < queries.size(); ++t)
      for (size_t i = 0; i < count; ++i)
        out[t * stride + (part - first) + i] =
            static_cast<uint16_t>(rounded_mean(sums[t * count + i], training.length));
  }
}

uint64_t row_total(Training& training, DescriptorRow row) {
  std::call_once(training.has_totals,
                 [&] { training.totals = sum_differences(training.sequences, training.length); });
  uint64_t sum = 0;
  for (size_t x = 0; x < row.size(); ++x) sum += static_cast<uint64_t>(training.totals[x][row[x]]);
  return rounded_mean(sum, training.length);
}

FrameDistances distances_of(const std::shared_ptr<Training>& training, const DescriptorSpan& of) {
  FrameDistances distances = frames_to_compare(training->sequences, of);
  const auto pictures =
      std::make_shared<const std::vector<uint8_t>>(padded(of.rows, training->padded_length));
  distances.tile = [training, pictures](std::span<const uint32_t> queries, size_t first,
                                        size_t last, uint16_t* out, size_t stride) {
    fill_tile(*training, *pictures, queries, first, last, out, stride);
  };
  distances.row_total = [training, rows = of.rows](size_t frame) {
    return row_total(*training, rows[frame]);
  };
  distances.of_query = [training](const DescriptorSpan& other) {
    return distances_of(training, other);
  };
  return distances;
}

}  // namespace

uint16_t largest_gray(const DescriptorShape&) { return (kLevels - 1) * kUnits; }

uint32_t gray_distance(DescriptorRow a, DescriptorRow b) {
  uint64_t sum = 0;
  for (size_t x = 0; x < a.size(); ++x) sum += static_cast<uint64_t>(std::abs(a[x] - b[x]));
  return static_cast<uint32_t>(rounded_mean(sum, a.size()));
}

// Weights are multiples of 2^-20, so their sums are exact in any order.
Projector gray_projector(const DescriptorRows& to, std::span<const ComponentValues> weights) {
  const size_t length = to.shape.length;
  const auto sums = std::make_shared<std::vector<OfLevel<ComponentValues>>>(length);
  for (size_t x = 0; x < length; ++x) {
    for (size_t k = 0; k < kMaxComponents; ++k) {
      OfLevel<double> of_level = {};
      for (size_t i = 0; i < to.size(); ++i) of_level[to[i][x]] += weights[i][k];
      of_level = differences_to(of_level);
      for (size_t v = 0; v < kLevels; ++v) (*sums)[x][v][k] = of_level[v];
    }
  }
  return [sums, length](DescriptorRow row) {
    ComponentValues values = {};
    for (size_t x = 0; x < length; ++x)
      for (size_t k = 0; k < kMaxComponents; ++k) values[k] += (*sums)[x][row[x]][k];
    for (double& value : values) value *= static_cast<double>(kUnits) / static_cast<double>(length);
    return values;
  };
}

FrameDistances gray_distances(std::span<const DescriptorSpan> train, const DescriptorSpan& query) {
  const auto training = std::make_shared<Training>();
  training->sequences.assign(train.begin(), train.end());
  training->kernels = select_gray_kernels();
  training->length = query.rows.shape.length;
  training->padded_length = round_up(training->length, kGrayPixels);
  for (const DescriptorSpan& sequence : train) {
    const std::vector<uint8_t> rows = padded(sequence.rows, training->padded_length);
    training->rows.insert(training->rows.end(), rows.begin(), rows.end());
  }
  return distances_of(training, query);
}

}  // namespace vpr
