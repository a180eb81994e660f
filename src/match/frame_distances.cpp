#include "match/frame_distances.h"

#include <algorithm>
#include <array>
#include <cassert>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel.h"
#include "match/given_distances.h"
#include "match/plain.h"

namespace vpr {
namespace {

constexpr size_t kChunkFrames = 2048;  // descriptors of a chunk stay in the second-level cache

constexpr std::array<DistanceKind, 6> kKinds = {{
    {"hamming",
     ElementType::bits,
     {"bits", 1},
     largest_hamming,
     hamming_distance,
     plain_hamming,
     plain_hamming_unrounded,
     hamming_projector,
     hamming_distances},
    {"cosine",
     ElementType::int8,
     {"units of cosine distance", 2.0 / 65535},
     largest_cosine,
     cosine_distance,
     plain_cosine,
     plain_cosine_unrounded,
     cosine_projector,
     cosine_distances},
    {"cosine of 16-bit integers",
     ElementType::int16,
     {"units of cosine distance", 2.0 / 65535},
     largest_cosine,
     wide_cosine_distance,
     plain_wide_cosine,
     plain_wide_cosine_unrounded,
     wide_cosine_projector,
     wide_cosine_distances},
    {"euclidean",
     ElementType::points16,
     {"units of coordinates", 1},
     largest_point,
     point_distance,
     plain_point,
     plain_point_unrounded,
     point_projector,
     point_distances},
    {"absolute differences",
     ElementType::gray_levels,
     {"256ths of a gray level", 1.0 / 256},
     largest_gray,
     gray_distance,
     plain_gray,
     plain_gray_unrounded,
     gray_projector,
     gray_distances},
    {"given",
     ElementType::frame_numbers,
     {"units of the scores", 1},
     largest_given,
     number_distance,
     number_distance,
     [](DescriptorRow a, DescriptorRow b) -> double { return number_distance(a, b); },
     number_projector,
     given_distances},
}};

void check_shapes(std::span<const DescriptorSpan> sequences, const DescriptorShape& shape) {
  for (const DescriptorSpan& sequence : sequences)
    if (!sequence.rows.empty() && sequence.rows.shape != shape)
      throw Error(ErrorKind::data,
                  fmt::format("descriptors of {} and of {} elements can't be compared",
                              sequence.rows.shape.length, shape.length));
}

uint64_t total_of_row(const FrameDistances& distances, size_t query) {
  if (distances.row_total) return distances.row_total(query);
  std::vector<uint16_t> row;
  compute_row(distances, query, row);
  return row_sum(distances, row);
}

// The sum over all pairs; below 2^64 for sets of less than 100 million frames of 1386 bits.
uint64_t total_of_pairs(const FrameDistances& distances) {
  uint64_t sum = 0;
  for (const FrameRun& run : distances.query_runs)
    for (size_t frame = run.first; frame < run.first + run.count; ++frame)
      sum += total_of_row(distances, frame);
  return sum;
}

}  // namespace

const DistanceKind& distance_of(ElementType element) {
  const auto kind = std::find_if(kKinds.begin(), kKinds.end(),
                                 [&](const DistanceKind& row) { return row.element == element; });
  assert(kind != kKinds.end());
  return *kind;
}

FrameDistances frame_distances(std::span<const DescriptorSpan> train, const DescriptorSpan& query) {
  check_shapes(train, query.rows.shape);
  return distance_of(query.rows.shape.element).make(train, query);
}

FrameDistances frames_to_compare(std::span<const DescriptorSpan> train,
                                 const DescriptorSpan& query) {
  FrameDistances distances;
  distances.largest = largest_distance(query.rows.shape);
  distances.unit = distance_of(query.rows.shape.element).unit;
  distances.train.assign(train.begin(), train.end());
  distances.query = query;
  distances.train_frames = count_frames(train);
  distances.query_frames = query.rows.size();
  distances.train_runs = readable_runs(train);
  distances.query_runs = readable_runs(query);
  distances.readable_frames = count_windows(distances.train_runs, 1);
  return distances;
}

uint16_t largest_distance(const DescriptorShape& shape) {
  return distance_of(shape.element).largest(shape);
}

uint32_t frame_distance(const DescriptorRows& rows, size_t a, size_t b) {
  return distance_of(rows.shape.element).pair(rows[a], rows[b]);
}

void compute_row(const FrameDistances& distances, size_t query, std::vector<uint16_t>& row) {
  const size_t frames = distances.train_frames;
  const auto asked = static_cast<uint32_t>(query);
  row.resize(frames + kStretchFrames);
  parallel_for((frames + kChunkFrames - 1) / kChunkFrames, {}, [&](size_t chunk) {
    const size_t first = chunk * kChunkFrames;
    const size_t last = std::min(first + kChunkFrames, frames);
    distances.tile({&asked, 1}, first, last, row.data() + first, 0);
  });
}

uint64_t row_sum(const FrameDistances& distances, std::span<const uint16_t> row) {
  uint64_t sum = 0;
  for (const FrameRun& run : readable_runs(distances.train))
    for (size_t i = run.first; i < run.first + run.count; ++i) sum += row[i];
  return sum;
}

double row_mean(const FrameDistances& distances, size_t query) {
  if (distances.readable_frames == 0) return 0;
  return static_cast<double>(total_of_row(distances, query)) /
         static_cast<double>(distances.readable_frames);
}

double mean_distance_between(const FrameDistances& distances) {
  const size_t queries = count_windows(distances.query_runs, 1);
  if (queries == 0 || distances.readable_frames == 0) return 0;
  return static_cast<double>(total_of_pairs(distances)) /
         (static_cast<double>(distances.readable_frames) * static_cast<double>(queries));
}

double mean_distance_within(const FrameDistances& own) {
  const auto frames = static_cast<double>(own.readable_frames);
  if (own.readable_frames < 2) return 0;
  return static_cast<double>(total_of_pairs(own)) / (frames * (frames - 1));
}

}  // namespace vpr
