#include "ground_truth/numbers.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/text.h"

namespace vpr {

std::optional<FrameText> parse_frame(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative) text.remove_prefix(1);
  if (text.empty() || text.find_first_not_of("0123456789") != std::string_view::npos)
    return std::nullopt;
  FrameText frame;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), frame.value);
  frame.in_range = error == std::errc{} && (!negative || frame.value == 0);
  return frame;
}

std::optional<double> parse_real(std::string_view text) {
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

std::vector<std::string_view> cells_of(std::string_view line) {
  if (line.find(',') == std::string_view::npos) return split_words(line);
  std::vector<std::string_view> cells;
  for (const std::string_view part : split(line, ',')) {
    const auto words = split_words(part);
    cells.push_back(words.size() == 1 ? words.front() : part);
  }
  return cells;
}

}  // namespace vpr
