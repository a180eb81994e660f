#include "ground_truth/loop_gap.h"

#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "ground_truth/numbers.h"
#include "ground_truth/times.h"

namespace vpr {
namespace {

constexpr double kMostGap = 1e9;

}  // namespace

LoopGap parse_loop_gap(const std::string& text, const std::string& flag) {
  const bool is_time = text.ends_with('s');
  const auto value = parse_real(is_time ? text.substr(0, text.size() - 1) : text);
  const bool is_whole = value && *value == std::floor(*value);
  if (!value || !(*value > 0 && *value <= kMostGap) || (!is_time && !is_whole))
    throw Error(ErrorKind::usage,
                fmt::format("{} says how long ago a place must have been left, in seconds or in "
                            "frames, as in {} 30s or {} 300; found \"{}\"",
                            flag, flag, flag, text));
  if (!is_time) return {{}, static_cast<size_t>(*value)};
  return {std::llround(*value * double{kSecond}), 0};
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

}  // namespace vpr
