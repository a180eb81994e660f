#include "match/strips.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>
#include <vector>

#include "base/parallel.h"

namespace vpr {
namespace {

constexpr size_t kTileQueries = 64;          // query frames that share a block in registers
constexpr size_t kStripRingBytes = 1 << 20;  // a strip's ring stays in the second-level cache
constexpr size_t kMinStripWidth = 256;
constexpr size_t kMaxStripWidth = 2048;

/// Diagonals first, first + 1, ... of a matrix of train frames x query frames. Diagonal d holds the
/// pairs (train frame d + f, query frame f); d may be negative.
struct Strip {
  ptrdiff_t first = 0;
  size_t width = 0;
};

struct StripLayout {
  size_t width = 0;
  size_t count = 0;
  bool has_ring = false;
};

size_t round_up(size_t value, size_t multiple) {
  return (value + multiple - 1) / multiple * multiple;
}

StripLayout plan_strips(size_t diagonals, const MatchSettings& settings, size_t longest) {
  const size_t ring_row = sizeof(uint16_t) * longest;
  const size_t by_cache = kStripRingBytes / ring_row / kTileQueries * kTileQueries;
  const size_t by_threads = round_up(diagonals / (4 * thread_count()) + 1, kTileQueries);
  StripLayout layout;
  layout.width = std::clamp(std::min(by_cache, by_threads), kMinStripWidth, kMaxStripWidth);
  layout.count = (diagonals + layout.width - 1) / layout.width;
  layout.has_ring = settings.memory_limit / thread_count() / ring_row >= layout.width;
  return layout;
}

// The number of diagonals from the one of the last query frame and the first train frame on: for a
// sequence against itself, those that lie in the past.
size_t count_diagonals(const FrameDistances& distances) {
  const auto lag = least_lag(distances);
  return lag ? distances.query_frames - *lag : distances.train_frames + distances.query_frames - 1;
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
  tile.first_train = train_first / kStretchFrames * kStretchFrames;
  const size_t width = round_up(train_last - tile.first_train, kStretchFrames);
  tile.stride = round_up(width, 64) + 32;  // rows must not share cache sets
  tile.values.resize(std::max(tile.values.size(), tile.stride * (query_last - query_first)));
  distances.tile(std::span(queries).first(query_last - query_first), tile.first_train, train_last,
                 tile.values.data(), tile.stride);
}

/// Processes one strip, tile by tile, for windows of several lengths at once, which share the
/// incoming distances. Rows outside the matrix count as distance 0.
class StripMatcher {
 public:
  StripMatcher(const FrameDistances& distances, std::span<const size_t> window_lengths,
               const RowKernels& kernels, const LengthRowConsumer& consume, Strip strip,
               bool has_ring)
      : distances_(distances),
        lengths_(window_lengths),
        longest_(*std::max_element(window_lengths.begin(), window_lengths.end())),
        kernels_(kernels),
        consume_(consume),
        strip_(strip),
        sums_(window_lengths.size(), std::vector<uint32_t>(strip.width, 0)),
        ring_(has_ring ? strip.width * longest_ : 0, 0),
        zeros_(strip.width, 0),
        leaving_(window_lengths.size()) {}

  void run(const Monitor& monitor) {
    const size_t first = strip_.first + ptrdiff_t(strip_.width) > 0
                             ? 0
                             : static_cast<size_t>(1 - strip_.first - ptrdiff_t(strip_.width));
    for (size_t query = first; query < distances_.query_frames; query += kTileQueries) {
      check_stop(monitor);
      const size_t end = std::min(query + kTileQueries, distances_.query_frames);
      const size_t train_first = train_begin(query);
      const size_t train_last = train_end(end - 1);
      if (train_first >= train_last) break;
      fill_tile(entering_, distances_, query, end, train_first, train_last);
      for (size_t l = 0; ring_.empty() && l < lengths_.size(); ++l)
        fill_leaving(leaving_[l], lengths_[l], query, end);
      for (size_t frame = query; frame < end; ++frame) advance(frame);
    }
  }

 private:
  // The strip crosses query frame f at train frames [train_begin(f), train_end(f)).
  size_t train_begin(size_t query) const {
    return static_cast<size_t>(std::max<ptrdiff_t>(0, strip_.first + ptrdiff_t(query)));
  }
  size_t train_end(size_t query) const {
    const ptrdiff_t end = strip_.first + ptrdiff_t(strip_.width) + ptrdiff_t(query);
    return static_cast<size_t>(std::clamp<ptrdiff_t>(end, 0, ptrdiff_t(distances_.train_frames)));
  }

  // Without a ring: recomputes the outgoing distances.
  void fill_leaving(Tile& leaving, size_t length, size_t query, size_t end) const {
    if (end <= length) return;
    const size_t first = query < length ? 0 : query - length;
    const size_t train_first = train_begin(first);
    const size_t train_last = train_end(end - 1 - length);
    if (train_first < train_last)
      fill_tile(leaving, distances_, first, end - length, train_first, train_last);
  }

  void advance(size_t query) {
    const size_t from = train_begin(query);
    const size_t to = train_end(query);
    if (from >= to) return;
    const auto lane = static_cast<size_t>(ptrdiff_t(from) - ptrdiff_t(query) - strip_.first);
    const uint16_t* entering = entering_.at(query, from);
    for (size_t l = 0; l < lengths_.size(); ++l) {
      uint32_t* sums = sums_[l].data() + lane;
      if (!ring_.empty())
        kernels_.slide(sums, entering, ring_row(query + longest_ - lengths_[l]) + lane, sums,
                       to - from);
      else
        slide_without_ring(l, query, from, to, entering, sums);
      if (ends_window(distances_, lengths_[l], query))
        emit_row(distances_, lengths_[l], query, from, {sums, to - from},
                 [&](const ScoreRow& row) { consume_(l, row); });
    }
    if (!ring_.empty()) std::copy(entering, entering + (to - from), ring_row(query) + lane);
  }

  // The incoming distances of query frame f, or of the frame longest_ before: the row of f mod
  // longest_. Rows without incoming distances are 0.
  uint16_t* ring_row(size_t query) { return ring_.data() + query % longest_ * strip_.width; }

  // The outgoing pair of (train frame i, query frame f) is (i - c_l, f - c_l), if it exists.
  void slide_without_ring(size_t l, size_t query, size_t from, size_t to, const uint16_t* entering,
                          uint32_t* sums) const {
    const size_t length = lengths_[l];
    const size_t split = query < length ? to : std::clamp(length, from, to);
    kernels_.slide(sums, entering, zeros_.data(), sums, split - from);
    if (split < to)
      kernels_.slide(sums + (split - from), entering + (split - from),
                     leaving_[l].at(query - length, split - length), sums + (split - from),
                     to - split);
  }

  const FrameDistances& distances_;
  std::span<const size_t> lengths_;
  size_t longest_;
  const RowKernels& kernels_;
  const LengthRowConsumer& consume_;
  Strip strip_;
  std::vector<std::vector<uint32_t>> sums_;  // per length
  std::vector<uint16_t> ring_;
  std::vector<uint16_t> zeros_;
  Tile entering_;
  std::vector<Tile> leaving_;  // per length, without a ring
};

}  // namespace

void match_strips(const FrameDistances& distances, std::span<const size_t> window_lengths,
                  const MatchSettings& settings, const Monitor& monitor,
                  const LengthRowConsumer& consume) {
  assert(!distances.is_in_order());
  const size_t diagonals = count_diagonals(distances);
  if (diagonals == 0) return;
  const size_t longest = *std::max_element(window_lengths.begin(), window_lengths.end());
  const StripLayout layout = plan_strips(diagonals, settings, longest);
  const ptrdiff_t first_diagonal = 1 - ptrdiff_t(distances.query_frames);
  StepCounter counter(monitor, "match", layout.count);
  parallel_for(layout.count, monitor, [&](size_t s) {
    const Strip strip{first_diagonal + ptrdiff_t(s * layout.width), layout.width};
    StripMatcher(distances, window_lengths, settings.kernels, consume, strip, layout.has_ring)
        .run(monitor);
    counter.add();
  });
}

}  // namespace vpr
