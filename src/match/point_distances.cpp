#include <algorithm>
#include <cmath>
#include <mutex>

#include "match/product_rows.h"

namespace vpr {
namespace {

using Coordinate = int16_t;

double same(double square) { return square; }

/// All training frames that rows are centred over are kept, too, where some are not searched.
struct Training : ProductTraining<Coordinate> {
  std::once_flag has_centre;
  std::shared_ptr<ProductTraining<Coordinate>> centre;
};

double exact_distance(DescriptorRow a, DescriptorRow b) {
  const int64_t square =
      square_of<Coordinate>(a) + square_of<Coordinate>(b) - 2 * product_of<Coordinate>(a, b);
  return std::sqrt(static_cast<double>(square));
}

// No sum over training frames is known in advance: each is compared.
uint64_t row_total(const std::shared_ptr<Training>& training, DescriptorRow row) {
  std::call_once(training->has_centre, [&] {
    training->centre = std::make_shared<ProductTraining<Coordinate>>();
    start_training<Coordinate>(*training->centre, training->centred_over, training->length,
                               training->centred_over, training->kernels, same);
  });
  const FrameDistances all = product_distances<Coordinate>(
      training->centre, {{{ElementType::coordinates, training->length}, row}, {}});
  std::vector<uint16_t> distances(all.train_frames + kStretchFrames);
  const uint32_t only = 0;
  all.tile({&only, 1}, 0, all.train_frames, distances.data(), distances.size());
  uint64_t sum = 0;
  for (const FrameRun& run : all.train_runs)
    for (size_t i = run.first; i < run.first + run.count; ++i) sum += distances[i];
  return sum;
}

FrameDistances distances_of(const std::shared_ptr<Training>& training, const DescriptorSpan& of) {
  FrameDistances distances = product_distances<Coordinate>(training, of);
  distances.row_total = [training, rows = of.rows](size_t frame) {
    return row_total(training, rows[frame]);
  };
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
      for (size_t k = 0; k < kMostComponents; ++k) values[k] += points->weights[i][k] * distance;
    }
    return values;
  };
}

FrameDistances point_distances(std::span<const DescriptorSpan> train, const DescriptorSpan& query,
                               std::span<const DescriptorSpan> centred_over) {
  const auto training = std::make_shared<Training>();
  start_training<Coordinate>(*training, train, query.rows.shape.length, centred_over,
                             select_point_kernels(), same);
  return distances_of(training, query);
}

}  // namespace vpr
