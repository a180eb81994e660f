#include <algorithm>
#include <cmath>
#include <memory>

#include "match/product_rows.h"

namespace vpr {
namespace {

using Coordinate = int16_t;

double same(double square) { return square; }

using Training = ProductTraining<Coordinate>;

double exact_distance(DescriptorRow a, DescriptorRow b) {
  const int64_t square =
      square_of<Coordinate>(a) + square_of<Coordinate>(b) - 2 * product_of<Coordinate>(a, b);
  return std::sqrt(static_cast<double>(square));
}

FrameDistances distances_of(const std::shared_ptr<Training>& training, const DescriptorSpan& of) {
  FrameDistances distances = product_distances<Coordinate>(training, of);
  distances.of_query = [training](const DescriptorSpan& other) {
    return distances_of(training, other);
  };
  return distances;
}

}  // namespace

uint16_t largest_point(const DescriptorShape&) { return 2 * kLongestPoint; }

uint32_t point_distance(DescriptorRow a, DescriptorRow b) {
  return static_cast<uint32_t>(std::lround(exact_distance(a, b)));
}

Projector point_projector(const DescriptorRows& to, std::span<const ComponentValues> weights) {
  struct Points {
    DescriptorShape shape;
    std::vector<uint8_t> bytes;
    std::vector<ComponentValues> weights;
  };
  const auto points = std::make_shared<const Points>(
      Points{to.shape, {to.bytes.begin(), to.bytes.end()}, {weights.begin(), weights.end()}});
  return [points](DescriptorRow row) {
    const DescriptorRows all(points->shape, points->bytes);
    ComponentValues values = {};
    for (size_t i = 0; i < all.size(); ++i) {
      const double distance = exact_distance(all[i], row);
      for (size_t k = 0; k < kMaxComponents; ++k) values[k] += points->weights[i][k] * distance;
    }
    return values;
  };
}

FrameDistances point_distances(std::span<const DescriptorSpan> train, const DescriptorSpan& query) {
  const auto training = std::make_shared<Training>();
  start_training<Coordinate>(*training, train, query.rows.shape.length, select_point_kernels(),
                             same);
  return distances_of(training, query);
}

}  // namespace vpr
