// Windows of several rates: the number of training frames that pass per query frame.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "match/rows.h"

namespace vpr {

inline constexpr uint32_t kMostRateFrames = 16;  ///< of both terms of a rate
inline constexpr size_t kMostRates = 64;

/// Parses "1/2", "3/2" or "1", reduced. Throws Error(usage) for other text, or for a term above
/// kMostRateFrames.
Rate parse_rate(const std::string& text);

/// Parses a list. Throws as parse_rate does, and Error(usage) for a duplicate rate, or more than
/// kMostRates.
std::vector<Rate> parse_rates(std::span<const std::string> texts);

/// Training frames per query frame.
constexpr double ratio_of(const Rate& rate) {
  return static_cast<double>(rate.train) / static_cast<double>(rate.query);
}

/// The offset of a window's k-th frame from the end before its last frame, in training frames:
/// floor((2 k p + q) / 2 q), which is k p / q rounded to nearest, ties up.
constexpr size_t rate_offset(const Rate& rate, size_t k) {
  return (2 * k * rate.train + rate.query) / (2 * size_t{rate.query});
}

/// The number of training frames spanned by a window of `window_length` query frames, at least 1.
constexpr size_t rate_span(const Rate& rate, size_t window_length) {
  return rate_offset(rate, window_length - 1) + 1;
}

/// The stage for windows of several rates (settings.rates, at least one) and lengths: for each
/// cell, the smallest sum over rates and its rate, the first one on a tie. S_r(j, i) = sum over m <
/// c_l of d(j - m, i - o_m) for windows that end at query frame j and training frame i, where o_m
/// is rate_offset, is computed from S_r(j - q, i - p), q incoming and q outgoing terms. A cell has
/// the position of rate 1, i - (c_l - 1); it exists if these c_l frames, and the training frames of
/// at least one rate, lie in one run. Memory: 2 (c_l + q) bytes per training frame for distances,
/// with the largest q, and 4 (q + 1) for each rate. Throws Error(usage) if it does not fit the
/// memory limit, or if a window is longer than kMaxScoredWindow.
WindowStage rate_stage(const FrameDistances& distances, std::span<const size_t> window_lengths,
                       const MatchSettings& settings);

}  // namespace vpr
