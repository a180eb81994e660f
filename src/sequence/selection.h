// The frames of a recording that are used, and their order: a lower frame rate, or a simulated
// speed, stops, the way back, pieces.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/random.h"

namespace vpr {

/// Paces that a replay may have, in frames of the recording a frame.
inline constexpr double kSlowestPace = 0.1;
inline constexpr double kFastestPace = 10;

/// A row of the table: how a recording of at least one frame is replayed.
struct WarpRule {
  std::string_view name;
  std::string_view summary;
  bool is_forward = true;  ///< sources never fall
  /// Frames of the replay for each of the recording, at least and at most, give or take one frame.
  double shortest = 1;
  double longest = 1;
  size_t least_frames = 1;  ///< that a recording must have
  /// The frame of the recording that each frame of the replay is. It depends on both arguments
  /// alone.
  std::vector<uint32_t> (*sources)(size_t frames, RandomEngine& engine);
};

/// The rows that have a name; any other pace is a number.
std::span<const WarpRule> warp_rules();

/// A name and a sentence a row, for help texts.
std::string warp_summaries();

/// A recording as it is replayed, or a part of its frames.
struct Replay {
  std::string warp = {};               ///< a row's name, or a pace; empty: as it was recorded
  uint64_t seed = 1;                   ///< of what is drawn
  size_t recorded_frames = 0;          ///< of the recording
  std::vector<uint32_t> sources = {};  ///< by frame of the replay: its frame of the recording
  double fps = 0;  ///< the rate that the recording was thinned to (thinning.h); 0: it was not

  size_t frames() const { return sources.size(); }
};

/// Throws Error(usage) unless `warp` is the name of a row or a pace, a number from kSlowestPace to
/// kFastestPace.
void check_warp(const std::string& warp);

/// The replay of a recording of `frames` frames; the same for the same arguments on every machine.
/// A pace p shows frame floor(k p) as its k-th, with p rounded to thousandths. Throws as check_warp
/// does, and Error(usage) for a recording that is too short for the rule.
Replay replay(const std::string& warp, size_t frames, uint64_t seed);

/// "replayed by varying, seed 1"; without the seed for a pace; "thinned to 5 frames a second", or
/// both.
std::string replay_text(const Replay& replay);

/// What belongs to each frame of the recording, for each frame of the replay.
template <class T>
std::vector<T> replayed(const std::vector<T>& recorded, const Replay& replay) {
  std::vector<T> shown;
  shown.reserve(replay.frames());
  for (const uint32_t source : replay.sources) shown.push_back(recorded[source]);
  return shown;
}

/// The frames of a replay whose frames of the recording are in `frames`, which rises; rising.
std::vector<size_t> replayed_frames(const Replay& replay, std::span<const size_t> frames);

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
