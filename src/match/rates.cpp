#include "match/rates.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <limits>
#include <memory>
#include <numeric>

#include <fmt/format.h>

#include "base/error.h"
#include "base/parallel.h"
#include "match/zscore_model.h"

namespace vpr {
namespace {

constexpr size_t kPartFrames = 16384;  // training frames per task

size_t padded(size_t frames) {
  return (frames + kStretchFrames - 1) / kStretchFrames * kStretchFrames;
}

/// Rows in a ring, each with leading zeros for positions before the first training frame; rows
/// before the first one are zeros as well.
template <class T>
struct Ring {
  size_t rows = 0;
  size_t front = 0;
  size_t stride = 0;
  std::vector<T> values;

  Ring(size_t row_count, size_t zeros, size_t frames)
      : rows(row_count), front(zeros), stride(zeros + padded(frames)), values(rows * stride, 0) {}
  /// Row `row`, if the ring still has it, `shift` training frames before frame `first`.
  T* at(size_t row, size_t first, size_t shift = 0) {
    assert(shift <= front);
    return values.data() + row % rows * stride + front + first - shift;
  }
};

struct RateSums {
  Rate rate;
  size_t span = 0;
  Ring<uint32_t> sums;  ///< of windows that end at the last q query frames, and at the next one
};

struct RatesState {
  size_t window_length = 0;
  size_t frames = 0;
  Ring<uint16_t> distances;
  std::vector<RateSums> rates;
  std::vector<uint32_t> best;
  std::vector<uint8_t> best_rate;
};

size_t largest_query(std::span<const Rate> rates) {
  size_t most = 1;
  for (const Rate& rate : rates) most = std::max<size_t>(most, rate.query);
  return most;
}

size_t bytes_needed(size_t frames, size_t window_length, std::span<const Rate> rates) {
  size_t bytes = sizeof(uint16_t) * (window_length + largest_query(rates));
  for (const Rate& rate : rates) bytes += sizeof(uint32_t) * (rate.query + 1);
  return bytes * padded(frames);
}

void check_settings(const FrameDistances& distances, std::span<const size_t> window_lengths,
                    const MatchSettings& settings) {
  size_t bytes = 0;
  for (const size_t length : window_lengths) {
    if (length > kMaxScoredWindow)
      throw Error(ErrorKind::usage,
                  fmt::format("windows of several rates allow a c_l of {} at most, found {}",
                              kMaxScoredWindow, length));
    bytes += bytes_needed(distances.train_frames, length, settings.rates);
  }
  if (bytes > settings.memory_limit)
    throw Error(ErrorKind::usage,
                fmt::format("windows of these rates over {} training frames need {} MiB of memory; "
                            "raise --max-memory",
                            distances.train_frames, (bytes >> 20) + 1));
}

RatesState start_length(const FrameDistances& distances, size_t length,
                        std::span<const Rate> rates) {
  const size_t frames = distances.train_frames;
  const size_t most = largest_query(rates);
  size_t front = 0;
  for (const Rate& rate : rates)
    front = std::max(front, rate_offset(rate, length + rate.query - 1));
  RatesState state{length, frames, Ring<uint16_t>(length + most, front, frames), {}, {}, {}};
  for (const Rate& rate : rates)
    state.rates.push_back({rate, rate_span(rate, length),
                           Ring<uint32_t>(rate.query + size_t{1}, rate.train, frames)});
  state.best.resize(frames);
  state.best_rate.resize(frames);
  return state;
}

// S(j, i) for training frames [first, last) from S(j - q, i - p) and the incoming and outgoing
// terms.
void slide_rate(RatesState& state, RateSums& of, const RowKernels& kernels, size_t frame,
                size_t first, size_t last) {
  const size_t q = of.rate.query;
  const size_t length = state.window_length;
  // Rows before the first one are those that no frame has reached yet: the index is never negative.
  const size_t now = frame + state.distances.rows;
  const size_t sum_now = frame + of.sums.rows;
  const uint32_t* before = of.sums.at(sum_now - q, first, of.rate.train);
  uint32_t* after = of.sums.at(sum_now, first);
  for (size_t m = 0; m < q; ++m) {
    const uint16_t* entering = state.distances.at(now - m, first, rate_offset(of.rate, m));
    const uint16_t* leaving =
        state.distances.at(now - length - m, first, rate_offset(of.rate, length + m));
    kernels.slide(m == 0 ? before : after, entering, leaving, after, last - first);
  }
}

template <class Body>
void for_each_part(size_t frames, const Body& body) {
  parallel_for((frames + kPartFrames - 1) / kPartFrames, {}, [&](size_t part) {
    body(part * kPartFrames, std::min((part + 1) * kPartFrames, frames));
  });
}

// Windows of all lengths use the same distances, which are computed once.
void take_distances(std::span<RatesState> states, const FrameDistances& distances,
                    const QueryFrame& frame) {
  const auto query = static_cast<uint32_t>(frame.row);
  if (distances.start_row) distances.start_row(query);
  const auto row = [&](RatesState& state, size_t first) {
    return state.distances.at(frame.number + state.distances.rows, first);
  };
  for_each_part(distances.train_frames, [&](size_t first, size_t last) {
    const uint16_t* taken = row(states[0], first);
    distances.tile({&query, 1}, first, last, row(states[0], first), 0);
    for (size_t l = 1; l < states.size(); ++l)
      std::copy(taken, taken + (last - first), row(states[l], first));
  });
}

void advance(RatesState& state, const RowKernels& kernels, size_t frame) {
  for_each_part(state.frames, [&](size_t first, size_t last) {
    for (RateSums& rate : state.rates) slide_rate(state, rate, kernels, frame, first, last);
  });
}

// The first end of a window in a run, for any rate.
size_t first_end(const RatesState& state, const FrameRun& run) {
  size_t least = std::numeric_limits<size_t>::max();
  for (const RateSums& rate : state.rates) least = std::min(least, rate.span);
  return run.first + std::max(state.window_length, least) - 1;
}

// The cells of a run, or nullopt if it is too short.
std::optional<ScoreRow> row_of_run(RatesState& state, const FrameRun& run, size_t frame) {
  const size_t begin = first_end(state, run);
  const size_t end = run.first + run.count;
  if (begin >= end) return std::nullopt;
  std::fill(state.best.begin() + begin, state.best.begin() + end,
            std::numeric_limits<uint32_t>::max());
  for (size_t r = 0; r < state.rates.size(); ++r) {
    RateSums& rate = state.rates[r];
    const uint32_t* sums = rate.sums.at(frame + rate.sums.rows, 0);
    for (size_t i = std::max(begin, run.first + rate.span - 1); i < end; ++i)
      if (sums[i] < state.best[i]) {
        state.best[i] = sums[i];
        state.best_rate[i] = static_cast<uint8_t>(r);
      }
  }
  const size_t first_window = run.first_in_sequence + (begin - run.first) + 1 - state.window_length;
  return ScoreRow{frame + 1 - state.window_length, run.sequence, first_window,
                  std::span(state.best).subspan(begin, end - begin),
                  std::span(state.best_rate).subspan(begin, end - begin)};
}

uint32_t parse_side(std::string_view text) {
  uint32_t value = 0;
  const auto read = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = read.ec == std::errc() && read.ptr == text.data() + text.size();
  return is_number && value <= kMostRateFrames ? value : 0;
}

}  // namespace

Rate parse_rate(const std::string& text) {
  const std::string_view whole = text;
  const size_t slash = whole.find('/');
  const uint32_t train = parse_side(whole.substr(0, slash));
  const uint32_t query = slash == std::string::npos ? 1 : parse_side(whole.substr(slash + 1));
  if (train == 0 || query == 0)
    throw Error(
        ErrorKind::usage,
        fmt::format("a rate is the ratio of training to query frames, such as 3/2 or 2, each from "
                    "1 to {}; found \"{}\"",
                    kMostRateFrames, text));
  const uint32_t common = std::gcd(train, query);
  return {train / common, query / common};
}

std::vector<Rate> parse_rates(std::span<const std::string> texts) {
  std::vector<Rate> rates;
  for (const std::string& text : texts) {
    const Rate rate = parse_rate(text);
    if (std::find(rates.begin(), rates.end(), rate) != rates.end())
      throw Error(ErrorKind::usage, fmt::format("the rate {} is listed twice", text));
    rates.push_back(rate);
  }
  if (rates.size() > kMostRates)
    throw Error(ErrorKind::usage, fmt::format("use at most {} rates", kMostRates));
  return rates;
}

WindowStage rate_stage(const FrameDistances& distances, std::span<const size_t> window_lengths,
                       const MatchSettings& settings) {
  assert(!settings.rates.empty());
  check_settings(distances, window_lengths, settings);
  const auto states = std::make_shared<std::vector<RatesState>>();
  for (const size_t length : window_lengths)
    states->push_back(start_length(distances, length, settings.rates));
  return [states, kernels = settings.kernels](const FrameDistances& rows, const QueryFrame& frame,
                                              const StageConsumer& consume) {
    take_distances(*states, rows, frame);
    for (size_t l = 0; l < states->size(); ++l) {
      RatesState& state = (*states)[l];
      advance(state, kernels, frame.number);
      if (frame.in_a_row < state.window_length) continue;
      std::vector<ScoreRow> row;
      for (const FrameRun& run : rows.train_runs)
        if (const auto piece = row_of_run(state, run, frame.number)) row.push_back(*piece);
      if (!row.empty()) consume(l, row);
    }
  };
}

}  // namespace vpr
