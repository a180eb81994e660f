#include "truth/times.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <regex>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"

namespace vpr {
namespace {

// 1896 and 2116 in nanoseconds since 1970: differences of two times and an offset fit 64 bits.
constexpr int64_t kMinTime = -(int64_t{1} << 61);
constexpr int64_t kMaxTime = int64_t{1} << 62;
/// Longer dates, which have many digits below nanoseconds, are refused.
constexpr size_t kMaxDate = 64;

/// Plausible steps between frames or poses, in nanoseconds; and those of clocks from 1970.
constexpr double kLeastStep = 2e6;
constexpr double kGreatestStep = 1e10;
constexpr double kLeastDateStep = 1e5;
constexpr double kGreatestDateStep = 3.6e12;
/// 2001 to 2039, in nanoseconds since 1970.
constexpr double kFirstDate = 1e18;
constexpr double kLastDate = 2.2e18;
constexpr std::array<std::pair<TimeUnit, std::string_view>, 4> kTimeUnits = {
    {{TimeUnit::seconds, "s"},
     {TimeUnit::milliseconds, "ms"},
     {TimeUnit::microseconds, "us"},
     {TimeUnit::nanoseconds, "ns"}}};

// Digits as an integer; 0 if empty. Nullopt if there are too many.
std::optional<int64_t> parse_digits(std::string_view digits) {
  return digits.empty() ? 0 : parse_number<int64_t>(digits);
}

}  // namespace

std::optional<TimeUnit> unit_of_time(std::string_view text) {
  const auto value = parse_real(text);
  if (!value) return std::nullopt;
  const double size = std::abs(*value);
  return size < 1e11   ? TimeUnit::seconds
         : size < 1e14 ? TimeUnit::milliseconds
         : size < 1e17 ? TimeUnit::microseconds
                       : TimeUnit::nanoseconds;
}

std::optional<TimeUnit> unit_of_times(const FileLocation& file,
                                      std::span<const std::string_view> texts) {
  const auto first = texts.empty() ? std::nullopt : parse_real(texts.front());
  if (!first) return std::nullopt;
  std::vector<double> values;  // lines that name images have any order
  bool has_points = false;
  bool are_whole = true;
  for (const std::string_view text : texts) {
    if (const auto value = parse_real(text)) {
      values.push_back(*value);
      are_whole = are_whole && std::trunc(*value) == *value;
    }
    has_points = has_points || text.find('.') < text.size();
  }
  std::ranges::sort(values);
  values.erase(std::unique(values.begin(), values.end()), values.end());
  std::vector<double> steps;
  for (size_t i = 1; i < values.size(); ++i) steps.push_back(values[i] - values[i - 1]);
  if (steps.empty()) return unit_of_time(texts.front());
  const auto middle = steps.begin() + static_cast<ptrdiff_t>((steps.size() - 1) / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  const auto is_between = [](double value, TimeUnit unit, double least, double greatest) {
    const double ns = value * static_cast<double>(unit);
    return ns >= least * (1 - 1e-9) && ns <= greatest * (1 + 1e-9);
  };
  std::vector<std::pair<TimeUnit, std::string_view>> plausible;
  for (const auto& [unit, symbol] : kTimeUnits) {
    // A phone that has been on for weeks counts as many nanoseconds as dates have microseconds.
    const double greatest = unit == TimeUnit::microseconds ? kGreatestStep : kGreatestDateStep;
    const bool is_date = is_between(*first, unit, kFirstDate, kLastDate) &&
                         is_between(*middle, unit, kLeastDateStep, kGreatestDateStep);
    if (is_date && is_between(*middle, unit, 0, greatest)) return unit;
    if (is_date || is_between(*middle, unit, kLeastStep, kGreatestStep))
      plausible.emplace_back(unit, symbol);
  }
  if (plausible.empty()) return unit_of_time(texts.front());
  if (has_points && plausible.front().first == TimeUnit::seconds) return TimeUnit::seconds;
  if (has_points && are_whole && plausible.front().first == TimeUnit::milliseconds)
    file.fail(
        "the unit of its times is unclear: they are {} {} or {} s apart. Add a first line with the "
        "names of the columns, such as time_{} or time_s",
        *middle, plausible[0].second, *middle, plausible[0].second);
  // A recording of less than a second has a larger unit.
  const double duration = values.back() - values.front();
  while (plausible.size() > 1 &&
         duration * static_cast<double>(plausible.back().first) < double{kSecond})
    plausible.pop_back();
  if (plausible.size() > 1)
    file.fail(
        "the unit of its times is unclear: they are {} {} or {} {} apart. Add a first line with "
        "the names of the columns, such as time_{} or time_{}, or write seconds with a point",
        *middle, plausible[0].second, *middle, plausible[1].second, plausible[0].second,
        plausible[1].second);
  return plausible.front().first;
}

std::optional<TimeUnit> unit_of_times(Rows& rows, std::string_view column) {
  if (const auto unit = rows.time_unit(column)) return unit;
  if (!rows.has(column)) return std::nullopt;
  const FileLocation file{rows.location().file};
  std::vector<std::string_view> texts;
  while (rows.next()) texts.push_back(rows.text(column));
  return unit_of_times(file, texts);
}

std::optional<int64_t> parse_time(std::string_view text, TimeUnit unit) {
  const auto value = parse_real(text);
  if (!value) return std::nullopt;
  const int64_t scale = static_cast<int64_t>(unit);
  if (text.find_first_of("eE") != std::string_view::npos) {
    const double rounded = *value * static_cast<double>(scale);
    if (!(rounded >= static_cast<double>(kMinTime) && rounded <= static_cast<double>(kMaxTime)))
      return std::nullopt;
    return std::llround(rounded);
  }
  const bool is_negative = text.starts_with('-');
  if (is_negative || text.starts_with('+')) text.remove_prefix(1);
  const size_t point = std::min(text.find('.'), text.size());
  const auto whole = parse_digits(text.substr(0, point));
  if (!whole || *whole > kMaxTime / scale) return std::nullopt;
  int64_t nanoseconds = *whole * scale;
  int64_t digit = scale;
  for (size_t i = point + 1; i < text.size() && digit > 1; ++i) {
    digit /= 10;
    nanoseconds += (text[i] - '0') * digit;
  }
  if (is_negative) nanoseconds = -nanoseconds;
  return nanoseconds >= kMinTime ? std::optional(nanoseconds) : std::nullopt;
}

std::string time_text(int64_t nanoseconds) {
  const bool is_negative = nanoseconds < 0;
  const uint64_t size = is_negative ? uint64_t{0} - static_cast<uint64_t>(nanoseconds)
                                    : static_cast<uint64_t>(nanoseconds);
  std::string text =
      fmt::format("{}{}.{:09}", is_negative ? "-" : "", size / kSecond, size % kSecond);
  while (text.back() == '0') text.pop_back();
  if (text.back() == '.') text.pop_back();
  return text;
}

size_t nearest_time(std::span<const int64_t> times, int64_t time) {
  const auto after = std::lower_bound(times.begin(), times.end(), time);
  const auto index = static_cast<size_t>(after - times.begin());
  if (index == times.size()) return index - 1;
  if (index == 0) return 0;
  return time - times[index - 1] <= times[index] - time ? index - 1 : index;
}

std::optional<int64_t> parse_calendar_time(std::string_view text) {
  static const std::regex kDate(
      R"((\d{4})([-/:]?)(\d\d)\2(\d\d)[Tt ](\d\d)(:?)(\d\d)\6(\d\d)(?:[.,](\d+))?)"
      R"(( ?(?:[Zz]|UTC|GMT)| ?([+-]\d\d)(?::?(\d\d))?(?: UTC)?)?)");
  std::cmatch parts;
  if (text.size() > kMaxDate ||
      !std::regex_match(text.data(), text.data() + text.size(), parts, kDate))
    return std::nullopt;
  const auto number = [&](size_t part) { return std::atoi(parts.str(part).c_str()); };
  const int zone_hours = std::abs(number(11));
  const std::chrono::seconds zone =
      std::chrono::hours(zone_hours) + std::chrono::minutes(number(12));
  const std::chrono::year_month_day date{std::chrono::year(number(1)),
                                         std::chrono::month(static_cast<unsigned>(number(3))),
                                         std::chrono::day(static_cast<unsigned>(number(4)))};
  if (number(1) < 1900 || number(1) > 2115 || !date.ok() || number(5) > 23 || number(7) > 59 ||
      number(8) > 60 || zone_hours > 15 || number(12) > 59)
    return std::nullopt;
  const std::chrono::sys_seconds local =
      std::chrono::sys_days(date) + std::chrono::hours(number(5)) +
      std::chrono::minutes(number(7)) + std::chrono::seconds(number(8));
  const std::chrono::sys_seconds utc = parts.str(11).starts_with('-') ? local + zone : local - zone;
  std::string fraction = parts.str(9);
  fraction.resize(9, '0');
  return utc.time_since_epoch().count() * kSecond + *parse_digits(fraction);
}

void refuse_time_order(const FileLocation& location, int64_t before, int64_t time) {
  location.fail("its time {} {}; times must increase", time_text(time),
                time == before ? "equals the time of the previous frame"
                               : fmt::format("is before the time of the previous frame, {}",
                                             time_text(before)));
}

int64_t TimeReader::read(const FileLocation& location, std::string_view text) {
  if (!unit_) unit_ = unit_of_time(text);
  auto time = unit_ ? parse_time(text, *unit_) : std::nullopt;
  if (!time) time = parse_calendar_time(text);
  if (!time)
    location.fail(
        "\"{}\" is not a valid time{}. Use numbers, or dates such as 2020-03-23T12:00:10Z", text,
        decimal_comma_hint(text));
  return *time;
}

int64_t TimeReader::read_next(const FileLocation& location, std::string_view text) {
  const int64_t time = read(location, text);
  if (last_ && time <= *last_) refuse_time_order(location, *last_, time);
  return *(last_ = time);
}

}  // namespace vpr
