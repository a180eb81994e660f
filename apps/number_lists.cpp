#include "number_lists.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "command.h"

namespace vpr {
namespace {

constexpr double kMostValues = 10'000;

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

double parse_number(const std::string& text, const std::string& flag) {
  const Json value = flag_value(text);
  if (!value.is_number())
    throw Error(ErrorKind::usage,
                fmt::format("{} takes numbers, lists or ranges, as in 2,5,10 or 0.2:0.6:0.05, "
                            "found \"{}\"",
                            flag, text));
  return value.get<double>();
}

}  // namespace

std::vector<double> parse_numbers(const std::string& text, const std::string& flag) {
  std::vector<double> numbers;
  for (const std::string& part : split(text, ',')) {
    const std::vector<std::string> range = split(part, ':');
    if (range.size() == 1) {
      numbers.push_back(parse_number(part, flag));
      continue;
    }
    const double first = parse_number(range[0], flag);
    const double last = parse_number(range[1], flag);
    const double step = range.size() > 2 ? parse_number(range[2], flag) : 1;
    const double count = std::floor((last - first) / step + 1e-9);
    if (range.size() > 3 || !(step > 0) || !(last >= first) || count > kMostValues)
      throw Error(ErrorKind::usage,
                  fmt::format("{}: a range is FIRST:LAST:STEP with at most {:.0f} values, found "
                              "\"{}\"",
                              flag, kMostValues, part));
    for (double i = 0; i <= count; ++i)
      numbers.push_back(std::round((first + i * step) * 1e9) / 1e9);
  }
  // A value that is given twice counts once, where it comes first.
  std::vector<double> once;
  for (const double number : numbers)
    if (std::find(once.begin(), once.end(), number) == once.end()) once.push_back(number);
  return once;
}

std::vector<uint64_t> parse_counts(const std::string& text, const std::string& flag) {
  std::vector<uint64_t> counts;
  for (const double number : parse_numbers(text, flag)) {
    if (!(number >= 1 && number <= 1e9) || number != std::floor(number))
      throw Error(ErrorKind::usage,
                  fmt::format("{} takes whole numbers from 1 on, found {:g}", flag, number));
    counts.push_back(static_cast<uint64_t>(number));
  }
  return counts;
}

}  // namespace vpr
