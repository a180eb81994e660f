// Times as text (seconds, nanoseconds of a clock, or dates) and the times of the frames of a
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
#include "sequence/sequence_source.h"
#include "truth/text_file.h"

namespace vpr {

/// Nanoseconds per second.
inline constexpr int64_t kSecond = 1'000'000'000;

/// The unit of the times in a file, determined by its first time.
enum class TimeUnit { seconds, milliseconds, microseconds, nanoseconds };

/// The unit of a number by its size, for clocks that count from 1970: seconds below 10^11,
/// milliseconds below 10^14, microseconds below 10^17, otherwise nanoseconds. Nullopt if `text` is
/// not a finite number.
std::optional<TimeUnit> unit_of_time(std::string_view text);

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

/// A time of a file in nanoseconds. Throws Error(data), with the line, for an invalid time.
int64_t read_time(const FileLocation& location, std::string_view text, TimeUnit unit);

/// Throws Error(data): times must increase, but `time` is not after `before`.
[[noreturn]] void refuse_time_order(const FileLocation& location, int64_t before, int64_t time);

/// Times in nanoseconds, one per line in the order of the frames: the first column of a CSV (or the
/// column `time`, if there is a header), or the first word of a line, as in KITTI's times.txt and
/// TUM's rgb.txt; lines that start with # are skipped. A range after the path selects frames.
/// Throws Error(input) if it cannot be read; Error(data), with the line, for invalid times and
/// times that do not increase.
std::vector<int64_t> read_time_list(const std::filesystem::path& path);

/// Times in nanoseconds from the names of a sequence's files, without their extensions. Throws as
/// read_frame_times does.
std::vector<int64_t> times_of_names(const SequenceSource& sequence);

/// Times in nanoseconds, one per frame: from a list (read_time_list), from the names of the images
/// of a folder, which must be numbers (1305031102.175304.png, 1403636579763555584.png), or from a
/// video, relative to its first frame. A range after the path selects frames. Throws Error(input)
/// if the path cannot be read; Error(data), with the image or line, for invalid times and times
/// that do not increase.
std::vector<int64_t> read_frame_times(const std::filesystem::path& path, const Monitor& monitor);

}  // namespace vpr
