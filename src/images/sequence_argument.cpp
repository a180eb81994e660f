#include "images/sequence_argument.h"

#include <charconv>
#include <string_view>

#include <fmt/format.h>

#include "base/error.h"

namespace vpr {
namespace {

// The number in front of `text`, cut off; nothing if there is no digit. Throws when too large.
std::optional<uint64_t> take_number(std::string_view& text, const std::string& argument) {
  uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc::result_out_of_range || value > (uint64_t{1} << 62))
    throw Error(ErrorKind::usage, fmt::format("{}: a frame number is too large", argument));
  text.remove_prefix(static_cast<size_t>(end - text.data()));
  return value;
}

bool take_colon(std::string_view& text) {
  if (!text.starts_with(':')) return false;
  text.remove_prefix(1);
  return true;
}

// Nothing if `text` is not of the form FIRST:LAST[:STEP].
std::optional<FrameRange> parse_range(std::string_view text, const std::string& argument) {
  if (text.find_first_not_of("0123456789:") != std::string_view::npos) return std::nullopt;
  FrameRange range;
  range.first = take_number(text, argument).value_or(0);
  if (!take_colon(text)) return std::nullopt;
  range.last = take_number(text, argument);
  if (take_colon(text)) range.step = take_number(text, argument).value_or(1);
  if (!text.empty()) return std::nullopt;
  return range;
}

}  // namespace

SequenceArgument parse_sequence_argument(const std::string& text) {
  std::error_code error;
  const size_t at = text.rfind('@');
  if (at == std::string::npos || std::filesystem::exists(text, error)) return {text, {}};
  const auto range = parse_range(std::string_view(text).substr(at + 1), text);
  if (!range) return {text, {}};
  if (range->step == 0)
    throw Error(ErrorKind::usage, fmt::format("{}: a step of 0 never ends; give 1 or more", text));
  if (range->last && *range->last <= range->first)
    throw Error(
        ErrorKind::usage,
        fmt::format("{}: the range is empty; LAST is excluded and must exceed FIRST", text));
  return {text.substr(0, at), *range};
}

std::optional<uint64_t> frame_in_range(const FrameRange& range, uint64_t recorded) {
  if (recorded < range.first || (range.last && recorded >= *range.last)) return std::nullopt;
  const uint64_t behind = recorded - range.first;
  return behind % range.step == 0 ? std::optional(behind / range.step) : std::nullopt;
}

std::optional<uint64_t> frame_count(const FrameRange& range) {
  if (!range.last) return std::nullopt;
  return *range.last <= range.first ? 0 : (*range.last - range.first - 1) / range.step + 1;
}

std::string range_hint(const std::filesystem::path& path) {
  return fmt::format(
      "; where the sequence is a range of a recording, give this file the same "
      "range, as in {}@60:111",
      path.string());
}

std::string range_text(const FrameRange& range) {
  if (range.is_all()) return "";
  return fmt::format("@{}:{}{}", range.first == 0 ? "" : std::to_string(range.first),
                     range.last ? std::to_string(*range.last) : "",
                     range.step == 1 ? "" : fmt::format(":{}", range.step));
}

}  // namespace vpr
