#include "number_lists.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "base/text.h"
#include "common/command.h"

namespace vpr {
namespace {

constexpr double kMostValues = 10'000;

template <class T>
void add_once(std::vector<T>& values, const T& value) {
  if (std::find(values.begin(), values.end(), value) == values.end()) values.push_back(value);
}

double parse_number(std::string_view text, const std::string& flag) {
  const Json value = flag_value(std::string(text));
  if (!value.is_number())
    throw Error(ErrorKind::usage,
                fmt::format("{} takes numbers, lists or ranges, as in 2,5,10 or 0.2:0.6:0.05, "
                            "found \"{}\"",
                            flag, text));
  return value.get<double>();
}

// One part of a list: a number, or a range.
std::vector<double> parse_part(std::string_view part, const std::string& flag) {
  const auto range = split(part, ':');
  if (range.size() == 1) return {parse_number(part, flag)};
  const double first = parse_number(range[0], flag);
  const double last = parse_number(range[1], flag);
  const double step = range.size() > 2 ? parse_number(range[2], flag) : 1;
  const double count = std::floor((last - first) / step + 1e-9);
  if (range.size() > 3 || !(step > 0) || !(last >= first) || count > kMostValues)
    throw Error(ErrorKind::usage,
                fmt::format("{}: a range is FIRST:LAST:STEP with at most {:.0f} values, found "
                            "\"{}\"",
                            flag, kMostValues, part));
  std::vector<double> numbers;
  for (int i = 0; i <= count; ++i) numbers.push_back(std::round((first + i * step) * 1e9) / 1e9);
  return numbers;
}

}  // namespace

std::vector<double> parse_numbers(const std::string& text, const std::string& flag) {
  std::vector<double> numbers;
  for (const std::string_view part : split(text, ','))
    for (const double number : parse_part(part, flag)) add_once(numbers, number);
  return numbers;
}

std::vector<std::optional<double>> parse_thresholds(const std::string& text,
                                                    const std::string& flag) {
  std::vector<std::optional<double>> thresholds;
  for (const std::string_view part : split(text, ',')) {
    if (part == "auto")
      add_once(thresholds, std::optional<double>());
    else
      for (const double number : parse_part(part, flag))
        add_once(thresholds, std::optional(number));
  }
  return thresholds;
}

std::vector<uint64_t> parse_counts(const std::string& text, const std::string& flag) {
  std::vector<uint64_t> counts;
  for (const double number : parse_numbers(text, flag)) {
    if (!(number >= 1 && number <= 1e9) || number != std::floor(number))
      throw Error(
          ErrorKind::usage,
          fmt::format("{} takes whole numbers from 1 to 1000000000, found {:.16g}", flag, number));
    counts.push_back(static_cast<uint64_t>(number));
  }
  return counts;
}

}  // namespace vpr
