// Windows of several rates: how many training frames pass while the query passes some.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "match/rows.h"

namespace vpr {

inline constexpr uint32_t kMostRateFrames = 16;  ///< of either side of a rate
inline constexpr size_t kMostRates = 64;

/// "1/2", "3/2" or "1", reduced. Throws Error(usage) for what is no such fraction, or has a side
/// above kMostRateFrames.
Rate parse_rate(const std::string& text);

/// All of a list. Throws as parse_rate does, and Error(usage) for a rate that is given twice, or
/// more than kMostRates.
std::vector<Rate> parse_rates(std::span<const std::string> texts);

/// Training frames a query frame.
constexpr double ratio_of(const Rate& rate) {
  return static_cast<double>(rate.train) / static_cast<double>(rate.query);
}

/// How many training frames before a window's last one its k-th frame from the end is:
/// floor((2 k p + q) / 2 q), k p / q to the nearest, a half up.
constexpr size_t rate_offset(const Rate& rate, size_t k) {
  return (2 * k * rate.train + rate.query) / (2 * size_t{rate.query});
}

/// Training frames that a window of `window_length` query frames spans, at least 1.
constexpr size_t rate_span(const Rate& rate, size_t window_length) {
  return rate_offset(rate, window_length - 1) + 1;
}

/// The stage for windows of several rates (settings.rates, at least one) and lengths: of each cell
/// the smallest sum over them, and which it is, of equals the first. S_r(j, i) = sum over m < c_l
/// of d(j - m, i - o_m) for windows that end at query frame j and training frame i, where o_m is
/// rate_offset, is computed from S_r(j - q, i - p), q terms that enter and q that leave. A cell is
/// named as one of rate 1 is, by i - (c_l - 1), and there is one where these c_l frames and the
/// training frames of one of the rates at least lie in one run.
/// Memory: 2 (c_l + q) bytes a training frame for distances, with the largest q, and 4 (q + 1) for
/// each rate. Throws Error(usage) if it does not fit the memory limit, or if a window is longer
/// than kMaxScoredWindow.
WindowStage rate_stage(const FrameDistances& distances, std::span<const size_t> window_lengths,
                       const MatchSettings& settings);

}  // namespace vpr
