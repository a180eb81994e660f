// A sequence as the user named it, and its selection: the frames of a recording that are used, and
// their order. A selection is a range, a lower frame rate, or a simulation of speed, stops,
// reversal and cuts.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/random.h"

namespace vpr {

/// The frames of a recording that form a sequence, in their order. An empty selection: all frames.
struct Selection {
  std::string speed = {};              ///< the name of a rule, or a speed; empty: as recorded
  uint64_t seed = 1;                   ///< for rules with random choices
  size_t recorded_frames = 0;          ///< number of frames of the recording
  std::vector<uint32_t> sources = {};  ///< for each frame, its frame of the recording
  double selected_fps = 0;  ///< the rate to which the recording was resampled; 0: not resampled

  bool is_all() const { return sources.empty(); }
  /// Whether frames are selected, also before `sources` has been read.
  bool is_selected() const { return !speed.empty() || selected_fps > 0; }
  size_t frames() const { return sources.size(); }
  /// The frame of the recording for a selected frame.
  size_t source_of(size_t frame) const { return is_all() ? frame : sources[frame]; }
};

/// "resampled to 5 frames per second", "at speed varying, seed 1" (without the seed for a speed),
/// or both; empty for all frames.
std::string selection_text(const Selection& selection);

/// The values of the selected frames, from the values of all frames of the recording.
template <class T>
std::vector<T> selected(std::vector<T> recorded, const Selection& selection) {
  if (selection.is_all()) return recorded;
  std::vector<T> values;
  values.reserve(selection.frames());
  for (const uint32_t source : selection.sources) values.push_back(recorded[source]);
  return values;
}

/// The indices of selected frames whose frames of the recording are in `frames`, which increases;
/// increasing.
std::vector<size_t> selected_frames(const Selection& selection, std::vector<size_t> frames);

/// Frames first, first + step, ... below last; without `last`, to the end.
struct FrameRange {
  uint64_t first = 0;
  std::optional<uint64_t> last;
  uint64_t step = 1;

  bool is_all() const { return first == 0 && !last && step == 1; }
  bool operator==(const FrameRange&) const = default;
};

/// The index in the range of frame `recorded` of the whole recording; nullopt outside the range.
std::optional<uint64_t> frame_in_range(const FrameRange& range, uint64_t recorded);

/// The number of frames of a range; nullopt for a range without an end.
std::optional<uint64_t> frame_count(const FrameRange& range);

/// Parses FIRST:LAST[:STEP]; nullopt for other text. Throws Error(usage), with `argument`, for an
/// empty or reversed range, a step of 0, or a number that is too large.
std::optional<FrameRange> parse_range(std::string_view text, const std::string& argument);

/// "@10:20", "@:20:2"; empty for all frames.
std::string range_text(const FrameRange& range);

/// Additional text for errors about a frame out of range, if the file `path` counts the frames of a
/// whole recording: ". If the sequence is ..., as in PATH@60:111".
std::string range_hint(const std::filesystem::path& path);

/// Limits of the speed, in frames of the recording per frame.
inline constexpr double kSlowestPace = 0.1;
inline constexpr double kFastestPace = 10;

/// An entry of the table: a simulated speed of a recording of at least one frame.
struct SpeedRule {
  std::string_view name;
  std::string_view summary;
  size_t least_frames = 1;  ///< minimum frames of the recording
  /// The frame of the recording for each selected frame. Depends only on the two arguments. Null
  /// for a constant speed.
  std::vector<uint32_t> (*sources)(size_t frames, RandomEngine& engine) = nullptr;
};

std::span<const SpeedRule> speed_rules();

/// One name and sentence per line, for help texts.
std::string speed_summaries();

/// Throws Error(usage) unless `speed` is the name of a rule or a speed, a number from kSlowestPace
/// to kFastestPace.
void check_speed(const std::string& speed);

/// The frames that a speed selects from a recording of `frames` frames; the same for equal
/// arguments on every machine. An empty speed selects all. For a speed p, the k-th frame is frame
/// floor(k p), with p rounded to thousandths. Throws as check_speed does, and Error(usage) for a
/// recording that is too short for the rule.
Selection at_speed(const std::string& speed, size_t frames, uint64_t seed);

/// The maximum rate in frames per second; rates are above 0.
inline constexpr double kMaxFps = 1000;

/// Maximum number of recorded frames per selected frame, which limits the memory for a file.
inline constexpr uint64_t kMaxThinned = 100'000;

/// Throws Error(usage), with `name`, for a rate out of range.
void check_fps(double fps, std::string_view name);

/// Keeps the frame nearest in time to each tick, the earlier one on a tie, each frame at most once.
/// Ticks are 1/fps apart, starting at the first frame; a tick at most a tenth of that after the
/// last frame counts. Whether a frame is kept is known when the next one has arrived.
class Thinner {
 public:
  /// `fps` must pass check_fps.
  explicit Thinner(double fps);

  /// Whether the frame before the one at `time_ns` is kept; false for the first frame. Times are in
  /// nanoseconds and increase.
  bool keeps_before(int64_t time_ns);
  /// Whether the last frame is kept; false if there was none.
  bool keeps_last() const;

 private:
  /// Time from the first frame to the tick, in nanoseconds.
  double tick() const { return static_cast<double>(tick_) * interval_ns_; }

  double interval_ns_;
  uint64_t tick_ = 0;  ///< the next tick without a frame
  std::optional<int64_t> first_;
  int64_t last_ = 0;
};

/// The frames of a recording that Thinner keeps at a rate that passes check_fps. Times are in
/// nanoseconds and increase.
Selection resampled(std::span<const int64_t> times_ns, double fps);

/// The median rate of frames with these times, in frames per second; nullopt for fewer than two.
std::optional<double> median_fps(std::span<const int64_t> times_ns);

/// A sequence as the user named it. Passed whole, never member by member.
struct Sequence {
  std::string name;
  size_t frames = 0;  ///< number of frames
  /// The names of frames: the image's file name, or "#12" for a video. Empty: unknown.
  std::vector<std::string> frame_names = {};
  /// increasing; frames that keep their index but have no image
  std::vector<size_t> unreadable = {};
  std::optional<double> fps = {};  ///< frames per second, if known
  Selection selection = {};        ///< the selected frames of the recording
  /// Width and height of the first readable frame, if known.
  std::optional<std::array<uint32_t, 2>> size = {};

  size_t recorded_frames() const { return selection.is_all() ? frames : selection.recorded_frames; }
};

/// The selected frames of `sequence`; the result's selection refers to the recording.
Sequence selected(Sequence sequence, const Selection& selection);

/// The selected frames of several sequences, one sequence after the other.
std::vector<int32_t> source_rows(std::span<const Sequence* const> sequences);

/// Sets the selected frames of sequences that were read from JSON, from the rows of source_rows,
/// which `open_rows` opens if needed. Calls `fail`, which must throw, if they do not match.
void read_sources(std::span<Sequence* const> sequences,
                  const std::function<std::vector<int32_t>()>& open_rows,
                  const std::function<void()>& fail);

}  // namespace vpr
