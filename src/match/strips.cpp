#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>
#include <vector>

#include "base/parallel.h"
#include "match/fastable.h"
#include "match/row_kernels.h"

namespace vpr {
namespace {

constexpr size_t kTileQueries = 64;          // query frames that share a block in registers
constexpr size_t kStripRingBytes = 1 << 20;  // a strip's ring stays in the second-level cache
constexpr size_t kMinStripWidth = 256;
constexpr size_t kMaxStripWidth = 2048;
constexpr size_t kLeastStripWidth = 64;  // whatever the memory limit

/// Diagonals first, first + 1, ... of a matrix of train frames x query frames. Diagonal d holds the
/// pairs (train frame d + f, query frame f); d may be negative.
struct Strip {
  ptrdiff_t first = 0;
  size_t width = 0;
};

// The width of strips: their rings fit the cache and the memory limit, and every thread has several
// strips.
size_t strip_width(size_t diagonals, const MatchSettings& settings, size_t longest) {
  const size_t ring_row = sizeof(uint16_t) * longest;
  const size_t by_cache = kStripRingBytes / ring_row / kTileQueries * kTileQueries;
  const size_t by_threads = round_up(diagonals / (4 * thread_count()) + 1, kTileQueries);
  const size_t by_memory = settings.memory_limit / thread_count() / ring_row;
  return std::min(std::clamp(std::min(by_cache, by_threads), kMinStripWidth, kMaxStripWidth),
                  std::max(by_memory, kLeastStripWidth));
}

/// Distances of a tile of query frames to the train frames that a strip crosses there.
struct Tile {
  std::vector<uint16_t> values;
  size_t stride = 0;
  size_t first_query = 0;
  size_t first_train = 0;

  const uint16_t* at(size_t query, size_t train) const {
    return values.data() + (query - first_query) * stride + (train - first_train);
  }
};

// Compares train frames [train_first, train_last) with query frames [query_first, query_last).
void fill_tile(Tile& tile, const FrameDistances& distances, size_t query_first, size_t query_last,
               size_t train_first, size_t train_last) {
  std::array<uint32_t, kTileQueries> queries;
  std::iota(queries.begin(), queries.end(), static_cast<uint32_t>(query_first));
  tile.first_query = query_first;
  tile.first_train = train_first / kBlockFrames * kBlockFrames;
  const size_t width = round_up(train_last - tile.first_train, kBlockFrames);
  tile.stride = round_up(width, 64) + 32;  // rows must not share cache sets
  tile.values.resize(std::max(tile.values.size(), tile.stride * (query_last - query_first)));
  distances.tile(std::span(queries).first(query_last - query_first), tile.first_train, train_last,
                 tile.values.data(), tile.stride);
}

// Processes one strip, tile by tile, for windows of several lengths at once, which share the
// incoming distances. Rows outside the matrix count as distance 0.
void match_strip(const FrameDistances& distances, std::span<const size_t> window_lengths,
                 const Strip& strip, size_t longest, const Monitor& monitor,
                 const LengthRowConsumer& consume) {
  std::vector<std::vector<uint32_t>> sums(window_lengths.size(),
                                          std::vector<uint32_t>(strip.width, 0));
  // The row of frame f mod longest holds the distances of query frame f, or of the frame `longest`
  // before; zeros if there are none.
  std::vector<uint16_t> ring(strip.width * longest, 0);
  const auto ring_row = [&](size_t query) { return ring.data() + query % longest * strip.width; };
  // The strip crosses query frame f at train frames [begin_of(f), end_of(f)).
  const auto begin_of = [&](size_t query) {
    return static_cast<size_t>(std::max<ptrdiff_t>(0, strip.first + ptrdiff_t(query)));
  };
  const auto end_of = [&](size_t query) {
    const ptrdiff_t end = strip.first + ptrdiff_t(strip.width) + ptrdiff_t(query);
    return static_cast<size_t>(std::clamp<ptrdiff_t>(end, 0, ptrdiff_t(distances.train_frames)));
  };
  Tile tile;
  const auto first =
      static_cast<size_t>(std::max<ptrdiff_t>(0, 1 - strip.first - ptrdiff_t(strip.width)));
  for (size_t query = first; query < distances.query_frames; query += kTileQueries) {
    check_stop(monitor);
    const size_t query_end = std::min(query + kTileQueries, distances.query_frames);
    if (begin_of(query) >= end_of(query_end - 1)) break;
    fill_tile(tile, distances, query, query_end, begin_of(query), end_of(query_end - 1));
    for (size_t frame = query; frame < query_end; ++frame) {
      const size_t from = begin_of(frame);
      const size_t count = end_of(frame) - std::min(from, end_of(frame));
      if (count == 0) continue;
      const auto lane = static_cast<size_t>(ptrdiff_t(from) - ptrdiff_t(frame) - strip.first);
      const uint16_t* entering = tile.at(frame, from);
      for (size_t l = 0; l < window_lengths.size(); ++l) {
        const size_t length = window_lengths[l];
        uint32_t* window_sums = sums[l].data() + lane;
        slide_sums(window_sums, entering, ring_row(frame + longest - length) + lane, window_sums,
                   count);
        if (ends_window(distances, length, frame))
          emit_row(distances, length, frame, from, {window_sums, count},
                   [&](const ScoreRow& row) { consume(l, row); });
      }
      std::copy_n(entering, count, ring_row(frame) + lane);
    }
  }
}

}  // namespace

void match_strips(const FrameDistances& distances, std::span<const size_t> window_lengths,
                  const MatchSettings& settings, const Monitor& monitor,
                  const LengthRowConsumer& consume) {
  assert(!distances.is_in_order());
  const auto lag = least_lag(distances);
  // From the diagonal of the last query frame and the first train frame on: for a sequence against
  // itself, only those that lie in the past.
  const size_t diagonals =
      lag ? distances.query_frames - *lag : distances.train_frames + distances.query_frames - 1;
  if (diagonals == 0) return;
  const size_t longest = std::ranges::max(window_lengths);
  const size_t width = strip_width(diagonals, settings, longest);
  const size_t strips = divide_up(diagonals, width);
  StepCounter counter(monitor, "match", strips);
  parallel_for(strips, monitor, [&](size_t s) {
    const Strip strip{1 - ptrdiff_t(distances.query_frames) + ptrdiff_t(s * width), width};
    match_strip(distances, window_lengths, strip, longest, monitor, consume);
    counter.add();
  });
}

}  // namespace vpr
