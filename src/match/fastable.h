// FastABLE: sums of distances over windows, each from the previous sum on its diagonal (paper,
// section VII); frame by frame for windows of any rate, or for a whole query at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "match/match.h"

namespace vpr {

inline constexpr uint32_t kMostRateFrames = 16;  ///< of both terms of a rate
inline constexpr size_t kMostRates = 64;

/// Parses "1/2", "3/2" or "1", reduced. Throws Error(usage) for other text, or for a term above
/// kMostRateFrames.
Rate parse_rate(const std::string& text);

/// Throws as parse_rate does, and Error(usage) for a duplicate rate, or more than kMostRates.
std::vector<Rate> parse_rates(std::span<const std::string> texts);

/// Training frames per query frame.
constexpr double ratio_of(const Rate& rate) {
  return static_cast<double>(rate.train) / static_cast<double>(rate.query);
}

/// The number of training frames between the last frame of a window and the frame that belongs to
/// the k-th query frame before its last one: k p / q, rounded to nearest, ties up.
constexpr size_t rate_offset(const Rate& rate, size_t k) {
  return (2 * k * rate.train + rate.query) / (2 * size_t{rate.query});
}

/// The number of training frames spanned by a window of `window_length` query frames, at least 1.
constexpr size_t rate_span(const Rate& rate, size_t window_length) {
  return rate_offset(rate, window_length - 1) + 1;
}

/// Whether the ring of window_length + 1 rows of distances fits the memory limit.
bool ring_fits(size_t train_frames, size_t window_length, size_t memory_limit);

/// The stage for windows of these lengths. Distances of each frame are computed once and kept in a
/// ring of 2 (c_l + 1) bytes per training frame for the longest c_l; sums take 8 bytes per training
/// frame and length. Without room for the ring, outgoing distances are computed a second time.
/// Threads share long databases.
///
/// With settings.rates, p training frames per q query frames: S_r(j, i) = the sum over m < c_l of
/// d(j - m, i - o_m) for windows that end at query frame j and training frame i, where o_m is
/// rate_offset, from S_r(j - q, i - p), q incoming and q outgoing terms. A cell is the smallest
/// sum over rates with its rate, the first one on a tie. It has the position of rate 1, i - (c_l -
/// 1), and exists if these c_l frames, and the training frames of at least one rate, lie in one
/// run. Memory: 2 (c_l + q) bytes per training frame for the largest q, and 4 (q + 1) for each rate
/// and length.
///
/// Distances in order and windows of several rates need the ring: throws Error(usage) if it does
/// not fit the memory limit, or if a window is longer than kMaxScoredWindow.
WindowStage fastable_stage(const FrameDistances& distances, std::span<const size_t> window_lengths,
                           const MatchSettings& settings);

/// The whole query at once, for searches without margins (maxima, sweeps of thresholds): up to
/// twice as fast as frame by frame. Strips of diagonals (train frame - query frame) are
/// independent: their running sums stay in place, and each strip has a ring of the longest window
/// length in its thread's cache. Strips are narrow enough for the memory limit, but at least 64
/// diagonals wide. Any tile of `distances` must be computable at any time; at least one of the two
/// sequences has a window.
void match_strips(const FrameDistances& distances, std::span<const size_t> window_lengths,
                  const MatchSettings& settings, const Monitor& monitor,
                  const LengthRowConsumer& consume);

}  // namespace vpr
