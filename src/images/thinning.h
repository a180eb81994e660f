// A recording at a lower rate: which of its frames are kept, by the times at which they were taken.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "images/warp.h"

namespace vpr {

/// Rates that may be asked for are above 0 and at most this, in frames a second.
inline constexpr double kMostFps = 1000;

/// Frames of a recording for one that is kept, at most: a file must not ask for memory without end.
inline constexpr uint64_t kMostThinned = 100'000;

/// Throws Error(usage), which calls it `name`, for a rate out of range.
void check_fps(double fps, std::string_view name);

/// Keeps of frames the one that is nearest in time to each tick, the earlier of two, and none
/// twice. Ticks are 1/fps apart, from the first frame on; one that is up to a tenth of that
/// behind the last frame counts. Whether a frame is kept is known when the next one is there.
class Thinner {
 public:
  /// Of a rate that check_fps takes.
  explicit Thinner(double fps);

  /// Whether the frame before the one of `time_ns` is kept. Times are in nanoseconds and rise; of
  /// the first frame, false.
  bool keeps_before(int64_t time_ns);
  /// Whether the last frame is kept; false if there was none.
  bool keeps_last() const;

 private:
  /// From the first frame to the tick, in nanoseconds.
  double tick() const { return static_cast<double>(tick_) * interval_ns_; }

  double interval_ns_;
  uint64_t tick_ = 0;  ///< the next that has no frame yet
  std::optional<int64_t> first_;
  int64_t last_ = 0;
};

/// The frames that a rate, which check_fps takes, keeps of a recording, whose times in nanoseconds
/// rise.
Replay thinned(std::span<const int64_t> times_ns, double fps);

/// What a file holds of frames that a rate kept: `sources` must rise and be below
/// `recorded_frames`; nothing where they do not, or where so many frames can't be meant.
std::optional<Replay> kept_frames(std::span<const int32_t> sources, uint64_t recorded_frames,
                                  double fps);

/// The median rate of frames with such times, in frames a second; nothing for less than two.
std::optional<double> median_fps(std::span<const int64_t> times_ns);

/// `replay`, which is of the frames that `kept` keeps, as one of the recording.
Replay replay_of_kept(const Replay& kept, Replay replay);

}  // namespace vpr
