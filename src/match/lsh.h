// Multi-probe locality-sensitive hashing of windows, as in ABLE-M for long sequences: approximate.
#pragma once

#include <functional>
#include <string_view>
#include <vector>

#include "match/match.h"

namespace vpr {

/// The name of the method.
inline constexpr std::string_view kLshMethod = "lsh";

/// The training windows that share a bucket with a query window of c_l contiguous codes: by
/// sequence, then window, without duplicates, and with exact scores D. Thread-safe.
using LshSearch = std::function<std::vector<Cell>(const uint8_t* window)>;

/// Hash tables over all windows of a database, without copies: the windows of a sequence are
/// overlapping rows of its codes, c_l codes wide and one code apart. (The tables are OpenCV's.) The
/// codes must outlive the search. The same seed yields the same tables for any number of threads.
/// Throws Error(usage) for settings out of range.
LshSearch make_lsh_search(std::span<const DescribedFrames> train, size_t window_length,
                          const LshSettings& settings, uint64_t seed, const Monitor& monitor);

/// Rows hold only the windows that were found. Throws Error(usage) for anything but plain Hamming
/// distances of bits.
void match_lsh(const FrameDistances& distances, const MatchSettings& settings,
               const Monitor& monitor, const RowConsumer& consume);

}  // namespace vpr
