// Moments as text: seconds, or the nanoseconds of a clock.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

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

}  // namespace vpr
