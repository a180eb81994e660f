// Moments as text: seconds, the nanoseconds of a clock, or dates; and the times of the frames of a
// sequence.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/monitor.h"
#include "sequence/sequence.h"
#include "truth/text_file.h"

namespace vpr {

/// Nanoseconds in a second.
inline constexpr int64_t kSecond = 1'000'000'000;

/// What a file's times count. A file has one unit: that of its first time.
enum class TimeUnit { seconds, milliseconds, microseconds, nanoseconds };

/// The unit of a number by its size, as clocks that count from 1970 have it: below 10^11 seconds,
/// below 10^14 milliseconds, below 10^17 microseconds, else nanoseconds. Nothing if `text` is no
/// finite number.
std::optional<TimeUnit> unit_of_time(std::string_view text);

/// Nanoseconds, exact for a decimal number with or without a point, whose further digits are cut
/// off; a number with an exponent is rounded to what float64 tells apart. Nothing if `text` is no
/// finite number, or above 2^62 nanoseconds.
std::optional<int64_t> parse_time(std::string_view text, TimeUnit unit);

/// "12.5" for 12 500 000 000: seconds without zeros at the end.
std::string time_text(int64_t nanoseconds);

/// The index of the time that is nearest to `time`, the earlier of two; `times` rise and there is
/// at least one.
size_t nearest_time(std::span<const int64_t> times, int64_t time);

/// Nanoseconds since 1970 of "2024-05-01T12:34:56[.789][Z|+02:00]" (ISO 8601; a blank may stand for
/// the T), UTC where it names no time zone. Digits below nanoseconds are cut off; the second may be
/// 60. Nothing for any other text, and before 1900 or after 2200.
std::optional<int64_t> parse_calendar_time(std::string_view text);

/// A time of a file, in nanoseconds. Throws Error(data), naming the line, for what is none.
int64_t read_time(const FileLocation& location, std::string_view text, TimeUnit unit);

/// Throws Error(data): times must rise, and `time` is not after `before`.
[[noreturn]] void refuse_time_order(const FileLocation& location, int64_t before, int64_t time);

/// Nanoseconds, one time a line in the order of the frames: the first column of a CSV (the column
/// `time` where its header has one), or the first word of a line, as KITTI's times.txt and TUM's
/// rgb.txt have it; lines that start with # are skipped. A range behind the path picks frames.
/// Throws Error(input) if it can't be read, Error(data), naming the line, for what is no time and
/// for times that do not rise.
std::vector<int64_t> read_time_list(const std::filesystem::path& path);

/// Nanoseconds, of the names of a sequence's files, without their extensions. Throws as
/// read_frame_times does.
std::vector<int64_t> times_of_names(const Sequence& sequence);

/// Nanoseconds, one a frame: of a list as read_time_list reads it, of the images of a folder by
/// their names, which must be numbers (1305031102.175304.png, 1403636579763555584.png), or of a
/// video since its first frame; a range behind the path picks frames. Throws Error(input) for what
/// can't be read, Error(data), naming the image or line, for what is no time and for times that do
/// not rise.
std::vector<int64_t> read_frame_times(const std::filesystem::path& path, const Monitor& monitor);

}  // namespace vpr
