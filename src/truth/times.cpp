#include "truth/times.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/mapped_file.h"
#include "base/text.h"
#include "sequence/video_reader.h"
#include "truth/text_file.h"

namespace vpr {
namespace {

constexpr int64_t kMaxTime = int64_t{1} << 62;

int64_t nanoseconds_in(TimeUnit unit) {
  switch (unit) {
    case TimeUnit::seconds:
      return kSecond;
    case TimeUnit::milliseconds:
      return 1'000'000;
    case TimeUnit::microseconds:
      return 1000;
    case TimeUnit::nanoseconds:
      return 1;
  }
  return kSecond;
}

// Digits as an integer; 0 if empty. Nullopt if there are too many.
std::optional<int64_t> whole_number(std::string_view digits) {
  int64_t value = 0;
  if (digits.empty()) return value;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

std::optional<int64_t> rounded_time(double value, int64_t scale) {
  const double nanoseconds = value * static_cast<double>(scale);
  if (!(std::abs(nanoseconds) <= static_cast<double>(kMaxTime))) return std::nullopt;
  return std::llround(nanoseconds);
}

/// The remaining text of a parser.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : rest_(text) {}

  bool at_end() const { return rest_.empty(); }
  /// Consumes and returns the next character if it is one of `wanted`; otherwise returns 0.
  char take(std::string_view wanted) {
    if (rest_.empty() || wanted.find(rest_.front()) == std::string_view::npos) return 0;
    const char found = rest_.front();
    rest_.remove_prefix(1);
    return found;
  }
  /// Parses a number of `digits` digits from `least` to `most`, after the character `before` unless
  /// that is 0.
  std::optional<int> number(char before, size_t digits, int least, int most) {
    if (before != 0 && take({&before, 1}) == 0) return std::nullopt;
    int value = 0;
    for (size_t i = 0; i < digits; ++i) {
      const char digit = take("0123456789");
      if (digit == 0) return std::nullopt;
      value = 10 * value + (digit - '0');
    }
    return value >= least && value <= most ? std::optional(value) : std::nullopt;
  }

 private:
  std::string_view rest_;
};

// Nanoseconds after a decimal point; 0 without one. Nullopt if no digit follows it.
std::optional<int64_t> scan_fraction(Scanner& scanner) {
  if (scanner.take(".,") == 0) return 0;
  int64_t fraction = 0;
  int64_t unit = kSecond;
  for (char digit = scanner.take("0123456789"); digit != 0; digit = scanner.take("0123456789")) {
    unit /= 10;
    fraction += (digit - '0') * unit;
  }
  return unit < kSecond ? std::optional(fraction) : std::nullopt;
}

// Seconds east of UTC.
std::optional<int64_t> scan_zone(Scanner& scanner) {
  const char sign = scanner.take("Zz+-");
  if (sign == 0 || sign == 'Z' || sign == 'z') return 0;
  const auto hours = scanner.number(0, 2, 0, 15);
  const bool has_minutes = scanner.take(":") != 0 || !scanner.at_end();
  const auto minutes = has_minutes ? scanner.number(0, 2, 0, 59) : 0;
  if (!hours || !minutes) return std::nullopt;
  return (sign == '+' ? 1 : -1) * (*hours * 3600 + *minutes * 60);
}

/// Every video has a byte within this range that does not occur in text.
constexpr size_t kStartBytes = 65536;

/// The index of the time column in the header; 0 if there is none.
size_t time_column(const std::vector<std::string_view>& header) {
  for (const std::string_view name : {"time", "timestamp", "time_s", "timestamp_ns"})
    for (size_t i = 0; i < header.size(); ++i)
      if (header[i] == name) return i;
  return 0;
}

bool is_text(const std::filesystem::path& path) {
  const MappedFile file(path);
  return file.text().substr(0, kStartBytes).find('\0') == std::string_view::npos;
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

std::optional<int64_t> parse_time(std::string_view text, TimeUnit unit) {
  const auto value = parse_real(text);
  if (!value) return std::nullopt;
  const int64_t scale = nanoseconds_in(unit);
  if (text.find_first_of("eE") != std::string_view::npos) return rounded_time(*value, scale);
  const bool is_negative = text.starts_with('-');
  if (is_negative || text.starts_with('+')) text.remove_prefix(1);
  const size_t point = std::min(text.find('.'), text.size());
  const auto whole = whole_number(text.substr(0, point));
  if (!whole || *whole > kMaxTime / scale) return std::nullopt;
  int64_t nanoseconds = *whole * scale;
  int64_t digit = scale;
  for (size_t i = point + 1; i < text.size() && digit > 1; ++i) {
    digit /= 10;
    nanoseconds += (text[i] - '0') * digit;
  }
  return is_negative ? -nanoseconds : nanoseconds;
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
  Scanner scanner(text);
  const auto year = scanner.number(0, 4, 1900, 2200);
  const auto month = scanner.number('-', 2, 1, 12);
  const auto day = scanner.number('-', 2, 1, 31);
  if (scanner.take("T ") == 0) return std::nullopt;
  const auto hour = scanner.number(0, 2, 0, 23);
  const auto minute = scanner.number(':', 2, 0, 59);
  const auto second = scanner.number(':', 2, 0, 60);
  const auto fraction_ns = scan_fraction(scanner);
  const auto zone_s = scan_zone(scanner);
  if (!year || !month || !day || !hour || !minute || !second || !fraction_ns || !zone_s ||
      !scanner.at_end())
    return std::nullopt;
  const std::chrono::year_month_day date{std::chrono::year(*year),
                                         std::chrono::month(static_cast<unsigned>(*month)),
                                         std::chrono::day(static_cast<unsigned>(*day))};
  if (!date.ok()) return std::nullopt;
  const int64_t days = std::chrono::sys_days(date).time_since_epoch().count();
  return (days * 86400 + *hour * 3600 + *minute * 60 + *second - *zone_s) * kSecond + *fraction_ns;
}

int64_t read_time(const FileLocation& location, std::string_view text, TimeUnit unit) {
  const auto time = parse_time(text, unit);
  if (!time) location.fail(fmt::format("\"{}\" is not a valid time", text));
  return *time;
}

void refuse_time_order(const FileLocation& location, int64_t before, int64_t time) {
  location.fail(fmt::format(
      "its time {} {}; times must increase", time_text(time),
      time == before
          ? "equals the time of the previous frame"
          : fmt::format("is before the time of the previous frame, {}", time_text(before))));
}

std::vector<int64_t> read_time_list(const std::filesystem::path& path) {
  const SequenceArgument source = parse_sequence_argument(path.string());
  const MappedFile file(source.path);
  FileLocation location{path.string()};
  std::vector<int64_t> times;
  std::optional<TimeUnit> unit;
  std::optional<int64_t> before;
  bool is_first = true;
  size_t column = 0;
  size_t line_number = 0;
  size_t index = 0;
  for (const std::string_view line : split_lines(without_byte_order_mark(file.text()))) {
    ++line_number;
    const auto cells = cells_of(line);
    if (cells.empty() || cells[0].starts_with('#')) continue;
    location.at("line", line_number);
    if (std::exchange(is_first, false) && !unit_of_time(cells[0])) {
      column = time_column(cells);  // a header
      continue;
    }
    if (column >= cells.size()) location.fail("has no time");
    if (!unit) unit = unit_of_time(cells[column]);
    if (!unit) location.fail(fmt::format("\"{}\" is not a valid time", cells[column]));
    const int64_t time = read_time(location, cells[column], *unit);
    if (before && time <= *before) refuse_time_order(location, *before, time);
    before = time;
    if (frame_in_range(source.range, index++)) times.push_back(time);
  }
  if (times.empty()) location.fail("has no times");
  return times;
}

std::vector<int64_t> times_of_names(const SequenceSource& sequence) {
  FileLocation location;
  std::vector<int64_t> times;
  std::optional<TimeUnit> unit;
  for (const std::filesystem::path& file : sequence.files) {
    location.file = file.string();
    const std::string name = file.stem().string();
    if (!unit) unit = unit_of_time(name);
    if (!unit)
      location.fail(
          fmt::format("its name \"{}\" is not a time; scripts/convert/exif.py lists when "
                      "JPEG images were taken",
                      name));
    const int64_t time = read_time(location, name, *unit);
    if (!times.empty() && time <= times.back()) refuse_time_order(location, times.back(), time);
    times.push_back(time);
  }
  return times;
}

std::vector<int64_t> read_frame_times(const std::filesystem::path& path, const Monitor& monitor) {
  const SequenceArgument source = parse_sequence_argument(path.string());
  std::error_code error;
  if (std::filesystem::is_directory(source.path, error))
    return times_of_names(open_sequence(source));
  if (is_text(source.path)) return read_time_list(path);
  return read_video_times(source, monitor);
}

}  // namespace vpr
