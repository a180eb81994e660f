// Times as text: seconds, nanoseconds of a clock, or dates.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/rows.h"

namespace vpr {

/// Nanoseconds per second.
inline constexpr int64_t kSecond = 1'000'000'000;

/// The unit of a single number by its size, for clocks that count from 1970: seconds below 10^11,
/// milliseconds below 10^14, microseconds below 10^17, otherwise nanoseconds. Nullopt if `text` is
/// not a finite number.
std::optional<TimeUnit> unit_of_time(std::string_view text);

/// The unit of the times of one file, in any order, by their median step: the unit in which it
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
/// Nullopt for other text and for times before 1900 or after 2115.
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

}  // namespace vpr
