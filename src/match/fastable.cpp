#include "match/fastable.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>

#include <oneapi/tbb/cache_aligned_allocator.h>

#include "base/error.h"
#include "base/text.h"
#include "match/row_kernels.h"
#include "match/zscores.h"

namespace vpr {
namespace {

// The number of values in whole cache lines.
template <class T>
size_t in_lines(size_t values) {
  constexpr size_t kCacheLineBytes = 64;
  return round_up(values, kCacheLineBytes / sizeof(T));
}

/// Rows in a ring, zeros before they are written. Each has leading zeros for positions before the
/// first training frame, which is aligned to a cache line.
template <class T>
struct Ring {
  size_t rows = 0;
  size_t front = 0;
  size_t stride = 0;
  std::vector<T, oneapi::tbb::cache_aligned_allocator<T>> values;

  Ring(size_t row_count, size_t zeros, size_t frames)
      : rows(row_count),
        front(in_lines<T>(zeros)),
        stride(front + in_lines<T>(frames)),
        values(rows * stride, 0) {}
  /// The value of training frame `frame` in the row that was written `back` rows before row `row`.
  T* at(size_t row, size_t back, size_t frame) {
    return values.data() + (row + rows - back) % rows * stride + front + frame;
  }
};

/// Windows of one length and rate.
struct WindowSums {
  size_t length = 0;
  Rate rate;
  Ring<uint32_t> sums;        ///< of windows that end at the last q query frames and the next one
  Ring<uint16_t> recomputed;  ///< without a ring: the row of outgoing distances
};

/// The state between query frames. Valid for one FrameDistances.
struct FastableState {
  std::optional<size_t> least_lag;  ///< for a sequence against itself (match.h)
  bool has_ring = false;
  Ring<uint16_t> distances;      ///< of the last frames; without a ring: one row
  std::vector<uint32_t> recent;  ///< without a ring: the rows of the last query frames
  std::vector<WindowSums> sums;  ///< by length, then by rate
};

/// The size of the ring of distances.
struct RingSize {
  size_t rows = 0;
  size_t front = 0;
  size_t bytes = 0;
};

RingSize ring_size(size_t train_frames, size_t longest, std::span<const Rate> rates) {
  RingSize size;
  for (const Rate& rate : rates) {
    size.rows = std::max<size_t>(size.rows, longest + rate.query);
    size.front = std::max(size.front, rate_offset(rate, longest + rate.query - 1));
  }
  size.bytes = sizeof(uint16_t) * size.rows *
               (in_lines<uint16_t>(size.front) + in_lines<uint16_t>(train_frames));
  return size;
}

FastableState start_fastable(const FrameDistances& distances,
                             std::span<const size_t> window_lengths,
                             const MatchSettings& settings) {
  const size_t frames = distances.train_frames;
  const size_t longest = std::ranges::max(window_lengths);
  const std::vector<Rate> rates = settings.rates.empty() ? std::vector<Rate>{{}} : settings.rates;
  const RingSize ring = ring_size(frames, longest, rates);
  size_t bytes = ring.bytes;
  for (const Rate& rate : settings.rates)
    bytes += sizeof(uint32_t) * (rate.query + 1) * frames * window_lengths.size();
  const bool has_ring = bytes <= settings.memory_limit;
  if (distances.is_in_order() || !settings.rates.empty()) {
    if (longest > kMaxScoredWindow)
      throw Error(ErrorKind::usage, "z-scores and rates allow a c_l of at most {}, found {}",
                  kMaxScoredWindow, longest);
    if (!has_ring)
      throw Error(
          ErrorKind::usage,
          "windows over {} training frames at c_l {} need {} MiB of memory; raise --max-memory",
          frames, longest, (bytes >> 20) + 1);
  }
  FastableState state{least_lag(distances),
                      has_ring,
                      Ring<uint16_t>(has_ring ? ring.rows : 1, ring.front, frames),
                      {},
                      {}};
  if (!has_ring) state.recent.resize(longest);
  for (const size_t length : window_lengths)
    for (const Rate& rate : rates)
      state.sums.push_back({length, rate,
                            Ring<uint32_t>(rate.query + size_t{1}, rate.train, frames),
                            Ring<uint16_t>(has_ring ? 0 : 1, length, frames)});
  return state;
}

// S(j, i) for training frames [first, last) from S(j - q, i - p) and the incoming and outgoing
// terms. `frame`: j.
void slide(FastableState& state, WindowSums& of, size_t frame, size_t first, size_t last) {
  const size_t q = of.rate.query;
  uint32_t* after = of.sums.at(frame, 0, first);
  for (size_t m = 0; m < q; ++m) {
    const uint32_t* before = m == 0 ? of.sums.at(frame, q, first) - of.rate.train : after;
    const uint16_t* entering = state.distances.at(frame, m, first) - rate_offset(of.rate, m);
    const uint16_t* leaving = state.has_ring ? state.distances.at(frame, of.length + m, first)
                                             : of.recomputed.at(0, 0, first);
    slide_sums(before, entering, leaving - rate_offset(of.rate, of.length + m), after,
               last - first);
  }
}

// Adds a query frame. For a sequence against itself, only training frames that it, or a later frame
// on their diagonal, may match are compared.
void advance(FastableState& state, const FrameDistances& distances, const QueryFrame& frame) {
  size_t compared = distances.train_frames;
  if (state.least_lag) compared = frame.number + 1 - std::min(*state.least_lag, frame.number + 1);
  const auto compare = [&](uint32_t query, size_t first, size_t last, uint16_t* out) {
    distances.tile({&query, 1}, first, last, out, 0);
  };
  if (distances.start_row) distances.start_row(frame.row);
  const auto slide_all = [&](size_t first, size_t last) {
    for (WindowSums& sums : state.sums) slide(state, sums, frame.number, first, last);
  };
  // Without a ring, the codes of a chunk are in the cache when outgoing frames are compared with
  // it.
  for_each_chunk(compared, [&](size_t first, size_t last) {
    compare(static_cast<uint32_t>(frame.row), first, last,
            state.distances.at(frame.number, 0, first));
    if (state.has_ring) return slide_all(first, last);
    for (WindowSums& sums : state.sums)
      if (frame.number >= sums.length)
        compare(state.recent[(frame.number - sums.length) % state.recent.size()], first, last,
                sums.recomputed.at(0, 0, first));
  });
  if (state.has_ring) return;
  for_each_chunk(compared, slide_all);  // reads outgoing distances of the chunk before
  state.recent[frame.number % state.recent.size()] = static_cast<uint32_t>(frame.row);
}

/// The smallest sum of every training frame over rates, and its rate.
struct BestRates {
  std::vector<uint32_t> sums;
  std::vector<uint8_t> rates;
};

// The cells of a run, for windows of one length and several rates; nullopt if it is too short.
std::optional<ScoreRow> best_of_rates(std::span<WindowSums> windows, const FrameStretch& run,
                                      size_t frame, BestRates& best) {
  const size_t length = windows.front().length;
  size_t shortest = std::numeric_limits<size_t>::max();
  for (const WindowSums& window : windows)
    shortest = std::min(shortest, rate_span(window.rate, length));
  const size_t begin = run.first + std::max(length, shortest) - 1;
  const size_t end = run.first + run.count;
  if (begin >= end) return std::nullopt;
  std::fill(best.sums.begin() + begin, best.sums.begin() + end,
            std::numeric_limits<uint32_t>::max());
  for (size_t r = 0; r < windows.size(); ++r) {
    const uint32_t* sums = windows[r].sums.at(frame, 0, 0);
    for (size_t i = std::max(begin, run.first + rate_span(windows[r].rate, length) - 1); i < end;
         ++i) {
      if (sums[i] >= best.sums[i]) continue;
      best.sums[i] = sums[i];
      best.rates[i] = static_cast<uint8_t>(r);
    }
  }
  return ScoreRow{frame + 1 - length, run.sequence,
                  run.first_in_sequence + (begin - run.first) + 1 - length,
                  std::span(best.sums).subspan(begin, end - begin),
                  std::span(best.rates).subspan(begin, end - begin)};
}

uint32_t parse_side(std::string_view text) {
  const uint32_t value = parse_number<uint32_t>(text).value_or(0);
  return value <= kMostRateFrames ? value : 0;
}

}  // namespace

Rate parse_rate(const std::string& text) {
  const std::string_view whole = text;
  const size_t slash = whole.find('/');
  const uint32_t train = parse_side(whole.substr(0, slash));
  const uint32_t query = slash == std::string::npos ? 1 : parse_side(whole.substr(slash + 1));
  if (train == 0 || query == 0)
    throw Error(ErrorKind::usage,
                "a rate is the ratio of training to query frames, such as 3/2 or 2, each from 1 to "
                "{}; found \"{}\"",
                kMostRateFrames, text);
  const uint32_t common = std::gcd(train, query);
  return {train / common, query / common};
}

std::vector<Rate> parse_rates(std::span<const std::string> texts) {
  std::vector<Rate> rates;
  for (const std::string& text : texts) {
    const Rate rate = parse_rate(text);
    if (std::ranges::find(rates, rate) != rates.end())
      throw Error(ErrorKind::usage, "the rate {} is listed twice", text);
    rates.push_back(rate);
  }
  if (rates.size() > kMostRates) throw Error(ErrorKind::usage, "use at most {} rates", kMostRates);
  return rates;
}

bool ring_fits(size_t train_frames, size_t window_length, size_t memory_limit) {
  const Rate one;
  return ring_size(train_frames, window_length, {&one, 1}).bytes <= memory_limit;
}

WindowStage fastable_stage(const FrameDistances& distances, std::span<const size_t> window_lengths,
                           const MatchSettings& settings) {
  const auto state =
      std::make_shared<FastableState>(start_fastable(distances, window_lengths, settings));
  const auto best = std::make_shared<BestRates>();
  if (!settings.rates.empty())
    *best = {std::vector<uint32_t>(distances.train_frames),
             std::vector<uint8_t>(distances.train_frames)};
  return [state, best, rates = settings.rates.size()](
             const FrameDistances& rows, const QueryFrame& frame, const StageConsumer& consume) {
    advance(*state, rows, frame);
    const size_t each = std::max<size_t>(rates, 1);
    for (size_t l = 0; l * each < state->sums.size(); ++l) {
      const std::span<WindowSums> windows = std::span(state->sums).subspan(l * each, each);
      const size_t length = windows.front().length;
      if (frame.consecutive_readable < length) continue;
      std::vector<ScoreRow> row;
      if (rates == 0)
        row = whole_row(rows, length, frame.number,
                        {windows.front().sums.at(frame.number, 0, 0), rows.train_frames});
      else
        for (const FrameStretch& run : rows.train_runs)
          if (const auto piece = best_of_rates(windows, run, frame.number, *best))
            row.push_back(*piece);
      if (!row.empty()) consume(l, row);
    }
  };
}

}  // namespace vpr
