// How long ago a place must have been left, so that to be there again closes a loop.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace vpr {

/// How long before a frame another must be, so that to be at one place closes a loop; bounds
/// included.
struct LoopGap {
  std::optional<int64_t> nanoseconds;  ///< none: `frames`
  size_t frames = 1;
};

/// "30s" or a whole number of frames, above 0. Throws Error(usage), beginning with `flag`, for
/// anything else.
LoopGap parse_loop_gap(const std::string& text, const std::string& flag);

/// Whether frame `match` is at least the gap before frame `query`. `times_ns`, which rise, are
/// only looked at if the gap is one of time.
bool is_past(const LoopGap& gap, std::span<const int64_t> times_ns, size_t query, size_t match);

/// By frame, how many frames from the first on are past. Rises.
std::vector<uint32_t> past_frames(const LoopGap& gap, std::span<const int64_t> times_ns,
                                  size_t frames);

}  // namespace vpr
