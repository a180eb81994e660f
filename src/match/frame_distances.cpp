#include "match/frame_distances.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <memory>
#include <numeric>

#include "base/error.h"

namespace vpr {
namespace {

constexpr size_t kChunkFrames = 2048;  // descriptors of a chunk stay in the second-level cache
constexpr size_t kRowsAhead = 16;
constexpr size_t kFramesPerThread = 32768;  // below this, a second thread costs more than it saves

constexpr std::array kKinds = {&kHammingDistance, &kCosineDistance, &kWideCosineDistance,
                               &kPointDistance,   &kGrayDistance,   &kLdbHogDistance};

FrameDistances compare(const std::vector<DescribedFrames>& train, const DescribedFrames& query,
                       const PreparedTraining& prepared) {
  FrameDistances distances;
  distances.largest = largest_distance(query.rows.shape);
  distances.train = train;
  distances.query = query;
  distances.train_frames = count_frames(train);
  distances.query_frames = query.rows.size();
  distances.train_runs = readable_runs(train);
  distances.query_runs = readable_runs(query);
  distances.readable_frames = count_windows(distances.train_runs, 1);
  prepared(distances);
  distances.of_query = [train, prepared](const DescribedFrames& other) {
    return compare(train, other, prepared);
  };
  return distances;
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
  for (const FrameStretch& run : distances.query_runs)
    for (size_t frame = run.first; frame < run.first + run.count; ++frame)
      sum += total_of_row(distances, frame);
  return sum;
}

}  // namespace

std::vector<FrameStretch> readable_runs(const DescribedFrames& sequence) {
  return readable_runs({&sequence, 1});
}

std::vector<FrameStretch> readable_runs(std::span<const DescribedFrames> sequences) {
  std::vector<FrameStretch> runs;
  size_t first = 0;
  for (size_t s = 0; s < sequences.size(); ++s) {
    size_t start = 0;
    const auto close = [&](size_t end) {
      if (end > start) runs.push_back({first + start, end - start, s, start});
      start = end + 1;
    };
    for (const size_t frame : sequences[s].unreadable) close(frame);
    close(sequences[s].rows.size());
    first += sequences[s].rows.size();
  }
  return runs;
}

size_t count_frames(std::span<const DescribedFrames> sequences) {
  size_t frames = 0;
  for (const DescribedFrames& sequence : sequences) frames += sequence.rows.size();
  return frames;
}

size_t count_windows(std::span<const FrameStretch> runs, size_t window_length) {
  size_t windows = 0;
  for (const FrameStretch& run : runs) windows += run.windows(window_length);
  return windows;
}

std::vector<uint8_t> readable_flags(std::span<const FrameStretch> runs, size_t frames) {
  std::vector<uint8_t> readable(frames, 0);
  for (const FrameStretch& run : runs)
    std::fill_n(readable.begin() + static_cast<ptrdiff_t>(run.first), run.count, uint8_t{1});
  return readable;
}

bool is_past(const LoopGap& gap, std::span<const int64_t> times_ns, size_t query, size_t match) {
  if (match >= query) return false;
  if (!gap.nanoseconds) return query - match >= gap.frames;
  return times_ns[query] - times_ns[match] >= *gap.nanoseconds;
}

std::vector<uint32_t> past_frames(const LoopGap& gap, std::span<const int64_t> times_ns,
                                  size_t frames) {
  std::vector<uint32_t> past;
  uint32_t count = 0;
  for (size_t frame = 0; frame < frames; ++frame) {
    while (is_past(gap, times_ns, frame, count)) ++count;
    past.push_back(count);
  }
  return past;
}

const DistanceKind& distance_of(ElementType element) {
  const auto kind = std::ranges::find(kKinds, element, &DistanceKind::element);
  assert(kind != kKinds.end());
  return **kind;
}

FrameDistances frame_distances(std::span<const DescribedFrames> train,
                               const DescribedFrames& query) {
  const DescriptorShape& shape = query.rows.shape;
  for (const DescribedFrames& sequence : train)
    if (!sequence.rows.empty() && sequence.rows.shape != shape)
      throw Error(ErrorKind::data, "descriptors of {} and of {} elements can't be compared",
                  sequence.rows.shape.length, shape.length);
  return compare({train.begin(), train.end()}, query,
                 distance_of(shape.element).prepare(train, shape));
}

uint16_t largest_distance(const DescriptorShape& shape) {
  return distance_of(shape.element).largest(shape);
}

uint32_t frame_distance(const DescriptorRows& rows, size_t a, size_t b) {
  return distance_of(rows.shape.element).pair(rows[a], rows[b]);
}

void for_each_chunk(size_t frames, const std::function<void(size_t first, size_t last)>& body) {
  const size_t parts = std::clamp<size_t>(frames / kFramesPerThread, 1, thread_count());
  const size_t part = round_up(divide_up(frames, parts), kChunkFrames);
  const auto run = [&](size_t p) {
    const size_t end = std::min((p + 1) * part, frames);
    for (size_t first = p * part; first < end; first += kChunkFrames)
      body(first, std::min(first + kChunkFrames, end));
  };
  if (parts == 1) return run(0);
  parallel_for(parts, {}, run);
}

void compute_row(const FrameDistances& distances, size_t query, std::vector<uint16_t>& row) {
  const auto asked = static_cast<uint32_t>(query);
  row.resize(distances.train_frames + kBlockFrames);
  parallel_for(divide_up(distances.train_frames, kChunkFrames), {}, [&](size_t chunk) {
    const size_t first = chunk * kChunkFrames;
    const size_t last = std::min(first + kChunkFrames, distances.train_frames);
    distances.tile({&asked, 1}, first, last, row.data() + first, 0);
  });
}

FrameDistances read_ahead(FrameDistances distances) {
  assert(distances.past.empty());
  /// The rows of query frames [first, last).
  struct Rows {
    size_t first = 0;
    size_t last = 0;
    size_t stride = 0;
    std::vector<uint16_t> values;
  };
  const auto rows = std::make_shared<Rows>();
  rows->stride = round_up(distances.train_frames, 64) + 32;  // rows must not share cache sets
  rows->values.resize(kRowsAhead * rows->stride);
  distances.start_row = [rows, of = distances](size_t query) {
    if (query >= rows->first && query < rows->last) return;
    rows->first = query;
    rows->last = std::min(query + kRowsAhead, of.query_frames);
    std::array<uint32_t, kRowsAhead> numbers;
    std::iota(numbers.begin(), numbers.end(), static_cast<uint32_t>(query));
    const std::span queries = std::span(numbers).first(rows->last - query);
    parallel_for(divide_up(of.train_frames, kChunkFrames), {}, [&](size_t chunk) {
      const size_t first = chunk * kChunkFrames;
      of.tile(queries, first, std::min(first + kChunkFrames, of.train_frames),
              rows->values.data() + first, rows->stride);
    });
  };
  distances.tile = [rows](std::span<const uint32_t> queries, size_t first, size_t last,
                          uint16_t* out, size_t) {
    assert(queries.size() == 1 && queries[0] >= rows->first && queries[0] < rows->last);
    const uint16_t* row = rows->values.data() + (queries[0] - rows->first) * rows->stride;
    std::copy(row + first, row + last, out);
  };
  return distances;
}

uint64_t row_sum(const FrameDistances& distances, std::span<const uint16_t> row) {
  uint64_t sum = 0;
  for (const FrameStretch& run : readable_runs(distances.train))
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
