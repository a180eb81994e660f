// Moments as dates and times of the day.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace vpr {

/// A moment, in nanoseconds since 1970 (UTC).
struct CalendarTime {
  int64_t ns = 0;
  bool has_zone = false;  ///< whether the text says its zone; otherwise it was taken for UTC
};

/// "2024-05-01T12:34:56[.789][Z|+02:00]" (ISO 8601; a blank may stand for the T, and the date may
/// have colons, as EXIF writes it). Digits below nanoseconds are cut off; the second may be 60.
/// Nothing for anything else, and before 1900 or after 2200.
std::optional<CalendarTime> parse_calendar_time(std::string_view text);

}  // namespace vpr
