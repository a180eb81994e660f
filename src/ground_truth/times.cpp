#include "ground_truth/times.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

#include "ground_truth/numbers.h"

namespace vpr {
namespace {

constexpr int64_t kMostTime = int64_t{1} << 62;

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

// Digits as a number; nothing at all is 0. Nothing if they are too many.
std::optional<int64_t> whole_number(std::string_view digits) {
  int64_t value = 0;
  if (digits.empty()) return value;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (error != std::errc{} || end != digits.data() + digits.size()) return std::nullopt;
  return value;
}

std::optional<int64_t> rounded_time(double value, int64_t scale) {
  const double nanoseconds = value * static_cast<double>(scale);
  if (!(std::abs(nanoseconds) <= static_cast<double>(kMostTime))) return std::nullopt;
  return std::llround(nanoseconds);
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
  if (!whole || *whole > kMostTime / scale) return std::nullopt;
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

}  // namespace vpr
