#include "ground_truth/calendar_time.h"

#include <chrono>

#include "ground_truth/times.h"

namespace vpr {
namespace {

/// What is left of a text, from its front.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : rest_(text) {}

  bool at_end() const { return rest_.empty(); }
  /// The first of `wanted` characters that comes next; 0 for none of them.
  char take(std::string_view wanted) {
    if (rest_.empty() || wanted.find(rest_.front()) == std::string_view::npos) return 0;
    const char found = rest_.front();
    rest_.remove_prefix(1);
    return found;
  }
  /// A number of exactly so many digits.
  std::optional<int> number(size_t digits) {
    int value = 0;
    for (size_t i = 0; i < digits; ++i) {
      const char digit = take("0123456789");
      if (digit == 0) return std::nullopt;
      value = 10 * value + (digit - '0');
    }
    return value;
  }

 private:
  std::string_view rest_;
};

std::optional<int64_t> scan_date(Scanner& scanner) {
  const auto year = scanner.number(4);
  if (!year || *year < 1900 || *year > 2200 || scanner.take("-:") == 0) return std::nullopt;
  const auto month = scanner.number(2);
  if (!month || scanner.take("-:") == 0) return std::nullopt;
  const auto day = scanner.number(2);
  if (!day) return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(*year),
                                         std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day))};
  if (!date.ok()) return std::nullopt;
  return std::chrono::sys_days(date).time_since_epoch().count() * int64_t{86400};
}

std::optional<int64_t> scan_clock(Scanner& scanner) {
  const auto hour = scanner.number(2);
  if (!hour || *hour > 23 || scanner.take(":") == 0) return std::nullopt;
  const auto minute = scanner.number(2);
  if (!minute || *minute > 59 || scanner.take(":") == 0) return std::nullopt;
  const auto second = scanner.number(2);
  if (!second || *second > 60) return std::nullopt;
  return *hour * 3600 + *minute * 60 + *second;
}

// Nanoseconds behind a point; nothing where no digit follows it.
std::optional<int64_t> scan_fraction(Scanner& scanner) {
  if (scanner.take(".,") == 0) return 0;
  int64_t fraction = 0;
  int64_t unit = kSecond;
  bool has_digit = false;
  for (char digit = scanner.take("0123456789"); digit != 0; digit = scanner.take("0123456789")) {
    has_digit = true;
    unit /= 10;
    fraction += (digit - '0') * unit;
  }
  if (!has_digit) return std::nullopt;
  return fraction;
}

// Seconds east of UTC, behind the sign.
std::optional<int64_t> scan_zone(Scanner& scanner) {
  const auto hours = scanner.number(2);
  if (!hours || *hours > 15) return std::nullopt;
  scanner.take(":");
  const auto minutes = scanner.at_end() ? std::optional<int>(0) : scanner.number(2);
  if (!minutes || *minutes > 59) return std::nullopt;
  return *hours * 3600 + *minutes * 60;
}

}  // namespace

std::optional<CalendarTime> parse_calendar_time(std::string_view text) {
  Scanner scanner(text);
  const auto date_s = scan_date(scanner);
  if (!date_s || scanner.take("T ") == 0) return std::nullopt;
  const auto clock_s = scan_clock(scanner);
  if (!clock_s) return std::nullopt;
  const auto fraction_ns = scan_fraction(scanner);
  if (!fraction_ns) return std::nullopt;
  CalendarTime time{(*date_s + *clock_s) * kSecond + *fraction_ns, false};
  if (scanner.at_end()) return time;
  time.has_zone = true;
  const char sign = scanner.take("Zz+-");
  if (sign == '+' || sign == '-') {
    const auto zone_s = scan_zone(scanner);
    if (!zone_s) return std::nullopt;
    time.ns -= (sign == '+' ? 1 : -1) * *zone_s * kSecond;
  }
  if (sign == 0 || !scanner.at_end()) return std::nullopt;
  return time;
}

}  // namespace vpr
