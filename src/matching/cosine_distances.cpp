#include <algorithm>
#include <cassert>
#include <cmath>
#include <memory>
#include <mutex>

#include <fmt/format.h>

#include "base/error.h"
#include "matching/cosine_kernels.h"
#include "matching/frame_distances.h"

namespace vpr {
namespace {

constexpr size_t kMostLength = 131071;  // scalar products fit 32 bits
constexpr double kLargest = 65535;      // of opposite directions
constexpr size_t kPart = 64;            // training frames whose products are kept at once

const int8_t* numbers(DescriptorRow row) { return reinterpret_cast<const int8_t*>(row.data()); }

double norm_of(DescriptorRow row) {
  int64_t sum = 0;
  for (size_t i = 0; i < row.size(); ++i) sum += int64_t{numbers(row)[i]} * numbers(row)[i];
  return std::sqrt(static_cast<double>(sum));
}

// The product is exact, and each of the few operations is rounded as IEEE says: the same on every
// machine. A vector of zeros is at right angles to all.
double cosine(int32_t product, double norms) {
  return norms > 0 ? static_cast<double>(product) / norms : 0;
}

uint32_t rounded(double cosine) {
  const double distance = (1 - cosine) * (kLargest / 2);
  return static_cast<uint32_t>(std::clamp(distance + 0.5, 0.0, kLargest));
}

/// What distances of any query to the same training frames share.
struct Training {
  std::vector<DescriptorSpan> sequences;
  std::vector<DescriptorSpan> centred_over;
  CosineKernels kernels;
  size_t length = 0;
  std::vector<int8_t> rows;
  std::vector<double> norms;
  std::once_flag has_sum;
  std::vector<double> unit_sum;  ///< of centred_over, made when it is first asked for
};

/// A query and the lengths of its vectors.
struct Query {
  DescriptorRows rows;
  std::vector<double> norms;
};

void append_norms(std::vector<double>& norms, const DescriptorRows& rows) {
  for (size_t i = 0; i < rows.size(); ++i) norms.push_back(norm_of(rows[i]));
}

// The vectors of all readable frames, each of length 1, added in their order.
std::vector<double> sum_of_units(std::span<const DescriptorSpan> sequences, size_t length) {
  std::vector<double> sum(length, 0);
  for (const DescriptorSpan& sequence : sequences) {
    for (const FrameRun& run : readable_runs(sequence)) {
      for (size_t i = run.first; i < run.first + run.count; ++i) {
        const DescriptorRow row = sequence.rows[i];
        const double norm = norm_of(row);
        for (size_t x = 0; norm > 0 && x < length; ++x) sum[x] += numbers(row)[x] / norm;
      }
    }
  }
  return sum;
}

void fill_tile(const Training& training, const Query& query, std::span<const uint32_t> queries,
               size_t first, size_t last, uint16_t* out, size_t stride) {
  assert(first % kStretchFrames == 0);
  std::vector<const int8_t*> vectors;
  for (const uint32_t frame : queries) vectors.push_back(numbers(query.rows[frame]));
  std::vector<int32_t> products(queries.size() * kPart);
  for (size_t part = first; part < last; part += kPart) {
    const size_t count = std::min(kPart, last - part);
    training.kernels.tile(vectors, training.rows.data() + part * training.length, count,
                          training.length, products.data());
    for (size_t t = 0; t < queries.size(); ++t)
      for (size_t i = 0; i < count; ++i)
        out[t * stride + (part - first) + i] = static_cast<uint16_t>(rounded(
            cosine(products[t * count + i], query.norms[queries[t]] * training.norms[part + i])));
  }
}

uint64_t row_total(Training& training, const Query& query, size_t frames, size_t frame) {
  std::call_once(training.has_sum,
                 [&] { training.unit_sum = sum_of_units(training.centred_over, training.length); });
  const int8_t* vector = numbers(query.rows[frame]);
  double sum = 0;
  for (size_t x = 0; x < training.length; ++x) sum += vector[x] * training.unit_sum[x];
  const double cosines = query.norms[frame] > 0 ? sum / query.norms[frame] : 0;
  return static_cast<uint64_t>(
      std::max((static_cast<double>(frames) - cosines) * (kLargest / 2) + 0.5, 0.0));
}

FrameDistances distances_of(const std::shared_ptr<Training>& training, const DescriptorSpan& of) {
  FrameDistances distances = frames_to_compare(training->sequences, of, training->centred_over);
  const auto query = std::make_shared<Query>(Query{of.rows, {}});
  append_norms(query->norms, of.rows);
  distances.tile = [training, query](std::span<const uint32_t> queries, size_t first, size_t last,
                                     uint16_t* out, size_t stride) {
    fill_tile(*training, *query, queries, first, last, out, stride);
  };
  distances.row_total = [training, query, frames = distances.centred_frames](size_t frame) {
    return row_total(*training, *query, frames, frame);
  };
  distances.of_query = [training](const DescriptorSpan& other) {
    return distances_of(training, other);
  };
  return distances;
}

}  // namespace

uint16_t largest_cosine(const DescriptorShape&) { return static_cast<uint16_t>(kLargest); }

uint32_t cosine_distance(DescriptorRow a, DescriptorRow b) {
  int32_t product = 0;
  for (size_t i = 0; i < a.size(); ++i) product += int32_t{numbers(a)[i]} * numbers(b)[i];
  return rounded(cosine(product, norm_of(a) * norm_of(b)));
}

Projector cosine_projector(const DescriptorRows& to, std::span<const ComponentValues> weights) {
  struct Sums {
    ComponentValues of_weights = {};
    std::vector<ComponentValues> of_units;  ///< of vectors of length 1, times their weights
  };
  const auto sums = std::make_shared<Sums>();
  sums->of_units.resize(to.shape.length);
  for (size_t i = 0; i < to.size(); ++i) {
    const double norm = norm_of(to[i]);
    for (size_t k = 0; k < kMostComponents; ++k) {
      sums->of_weights[k] += weights[i][k];
      for (size_t x = 0; norm > 0 && x < to.shape.length; ++x)
        sums->of_units[x][k] += weights[i][k] * (numbers(to[i])[x] / norm);
    }
  }
  return [sums](DescriptorRow row) {
    ComponentValues values = {};
    for (size_t x = 0; x < row.size(); ++x)
      for (size_t k = 0; k < kMostComponents; ++k)
        values[k] += numbers(row)[x] * sums->of_units[x][k];
    const double norm = norm_of(row);
    for (size_t k = 0; k < kMostComponents; ++k)
      values[k] = (sums->of_weights[k] - (norm > 0 ? values[k] / norm : 0)) * (kLargest / 2);
    return values;
  };
}

FrameDistances cosine_distances(std::span<const DescriptorSpan> train, const DescriptorSpan& query,
                                std::span<const DescriptorSpan> centred_over) {
  const size_t length = query.rows.shape.length;
  if (length > kMostLength)
    throw Error(ErrorKind::data, fmt::format("vectors of {} numbers: cosine distances take {} at "
                                             "most",
                                             length, kMostLength));
  const auto training = std::make_shared<Training>();
  training->sequences.assign(train.begin(), train.end());
  training->centred_over.assign(centred_over.begin(), centred_over.end());
  training->kernels = select_cosine_kernels();
  training->length = length;
  for (const DescriptorSpan& sequence : train) {
    const int8_t* rows = numbers(sequence.rows.bytes);
    training->rows.insert(training->rows.end(), rows, rows + sequence.rows.bytes.size());
    append_norms(training->norms, sequence.rows);
  }
  return distances_of(training, query);
}

}  // namespace vpr
