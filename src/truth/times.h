// Times as text (seconds, nanoseconds of a clock, or dates), the times of the frames of a sequence,
// its frame rate, and the selection of frames for a lower rate.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/json_fwd.h"
#include "base/monitor.h"
#include "base/rows.h"
#include "recordings/sequence_source.h"

namespace vpr {

struct LiveSource;

/// Nanoseconds per second.
inline constexpr int64_t kSecond = 1'000'000'000;

/// The unit of a single number by its size, for clocks that count from 1970: seconds below 10^11,
/// milliseconds below 10^14, microseconds below 10^17, otherwise nanoseconds. Nullopt if `text` is
/// not a finite number.
std::optional<TimeUnit> unit_of_time(std::string_view text);

/// The unit of the times of one file, which name none, by their median step: the unit in which it
/// is 2 ms to 10 s. Times that are dates of 2001 to 2039 in one unit may have steps from 0.1 ms to
/// one hour. Clocks of phones count from their start, so the size of a number alone says nothing.
/// If no unit fits, and for fewer than two numbers, as unit_of_time. Nullopt if the first text
/// is not a number. Throws Error(data) if two units
/// fit and all times cover at least a second in both.
std::optional<TimeUnit> unit_of_times(const FileLocation& file,
                                      std::span<const std::string_view> texts);
/// The unit in the name of a column or, without any, unit_of_times.
std::optional<TimeUnit> unit_of_times(Rows& rows, std::string_view column);

/// The time in nanoseconds. Exact for a decimal number with or without a point, whose excess digits
/// are truncated; a number with an exponent is rounded to float64. Nullopt if `text` is not a
/// finite number, or is above 2^62 nanoseconds.
std::optional<int64_t> parse_time(std::string_view text, TimeUnit unit);

/// "12.5" for 12 500 000 000: seconds without trailing zeros.
std::string time_text(int64_t nanoseconds);

/// The index of the time nearest to `time`, the earlier one on a tie; `times` increase and are not
/// empty.
size_t nearest_time(std::span<const int64_t> times, int64_t time);

/// Nanoseconds since 1970 for "2024-05-01T12:34:56[.789][Z|+02:00]" (ISO 8601; a blank may replace
/// the T), UTC without a time zone. Digits below nanoseconds are truncated; the second may be 60.
/// Nullopt for other text and for times before 1900 or after 2200.
std::optional<int64_t> parse_calendar_time(std::string_view text);

/// Throws Error(data): times must increase, but `time` is not after `before`.
[[noreturn]] void refuse_time_order(const FileLocation& location, int64_t before, int64_t time);

/// Reads the times of one file in nanoseconds: numbers or dates (parse_calendar_time). Without
/// `unit`, the size of the first number determines it.
class TimeReader {
 public:
  explicit TimeReader(std::optional<TimeUnit> unit = {}) : unit_(unit) {}

  /// Throws Error(data), with the line, for an invalid time.
  int64_t read(const FileLocation& location, std::string_view text);
  /// Also throws Error(data) for a time that is not after the last one.
  int64_t read_next(const FileLocation& location, std::string_view text);

 private:
  std::optional<TimeUnit> unit_;
  std::optional<int64_t> last_;
};

/// Times in nanoseconds, one per row in the order of the frames: the first cell, as in KITTI's
/// times.txt and TUM's rgb.txt, or the column `time` of a header. A range after the
/// path selects frames. Throws Error(input) if it cannot be read; Error(data), with the line, for
/// invalid times, times that do not increase, a first line that is neither a time nor such a
/// header, two columns without a header of which the first counts frames, and a first line that
/// seems to be pandas' header "0". If the column `image`, the second one without a header, names
/// some of the frames `names`, each frame has the time of the line with its name; Error(data) if
/// one has none.
std::vector<int64_t> read_time_list(const std::filesystem::path& path,
                                    const std::vector<std::string>& names = {});

/// Times in nanoseconds, one per frame: from a list (read_time_list), from the names of the images
/// of a folder, which must be numbers (1305031102.175304.png, 1403636579763555584.png), or from a
/// video, relative to its first frame. A range after the path selects frames. Throws Error(input)
/// if the path cannot be read; Error(data), with the image or line, for invalid times and times
/// that do not increase. `names`: of the frames, if known (read_time_list).
std::vector<int64_t> read_frame_times(const std::filesystem::path& path,
                                      const std::vector<std::string>& names,
                                      const Monitor& monitor);

/// Whether the name of an image, without its extension, is a time: a number with a decimal point or
/// at least ten digits.
bool is_named_by_time(const std::filesystem::path& file);

/// The selection of frames of a sequence, by the names of flags.
struct SelectionSettings {
  std::string speed;                   ///< simulated speed; empty: as recorded
  std::optional<double> fps;           ///< rate of the selected frames; nullopt: all frames
  std::optional<double> recorded_fps;  ///< rate of sequences that do not state it
  std::optional<double> fallback_fps;  ///< rate of sequences without any other source; not a flag
};
VPR_FIELDS(SelectionSettings, (speed), (fps), (recorded_fps))

/// Throws Error(usage) for rates out of range.
void check_rates(const SelectionSettings& settings);

/// Returns the argument with its rate, if known: from `times` (a file for read_frame_times; empty:
/// none), from times as file names (is_named_by_time), from a video, or from the stated rates,
/// which refer to all frames of the recording. With settings.fps, selects only the frames that
/// Thinner keeps, all of them above the rate of the sequence. `seed`: of the speed, which is
/// checked when the frames are known. Throws Error(usage) for rates out of range, and for
/// settings.fps without known times; Error(data) if times do not increase or their number differs
/// from the number of frames.
SequenceArgument selected(SequenceArgument argument, const SelectionSettings& settings,
                          const std::filesystem::path& times, uint64_t seed,
                          const Monitor& monitor);

/// The frames of `source` that Thinner keeps at `fps`, which must pass check_fps. The time of a
/// frame is the name of its image (is_named_by_time); for other names, frames have the constant
/// rate `recorded_fps`. Each frame is returned when the next one has arrived. Throws Error(usage)
/// for the first frame if neither is known; Error(data) for times that do not increase.
LiveSource open_resampled_source(LiveSource source, double fps, std::optional<double> recorded_fps);

}  // namespace vpr
