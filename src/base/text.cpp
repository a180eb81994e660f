#include "base/text.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include <fmt/format.h>

#include "base/json.h"

namespace vpr {

namespace {

std::string shown(std::string_view text, bool keeps_line_feeds) {
  const bool is_text = is_utf8(std::string(text));
  const auto byte_at = [&](size_t i) { return static_cast<uint8_t>(text[i]); };
  std::string result;
  for (size_t i = 0; i < text.size(); ++i) {
    const uint8_t byte = byte_at(i);
    // U+0080 to U+009F are encoded as c2 80 to c2 9f.
    const bool is_first_of_c1 = byte == 0xc2 && i + 1 < text.size() && byte_at(i + 1) < 0xa0;
    const bool is_last_of_c1 = byte >= 0x80 && byte < 0xa0 && i > 0 && byte_at(i - 1) == 0xc2;
    const bool is_control = byte < 0x20 || byte == 0x7f || is_first_of_c1 || is_last_of_c1;
    const bool stays = byte == '\n' ? keeps_line_feeds : !is_control && (byte < 0x80 || is_text);
    result += stays ? std::string(1, text[i]) : fmt::format("\\x{:02x}", byte);
  }
  return result;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Removes the leading digits from `text`. No number type is involved, so any length works.
std::string_view consume_digits(std::string_view& text) {
  const auto end = std::ranges::find_if_not(text, is_digit);
  const std::string_view digits(text.data(), static_cast<size_t>(end - text.begin()));
  text.remove_prefix(digits.size());
  return digits;
}

std::string_view without_leading_zeros(std::string_view digits) {
  digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size()));
  return digits;
}

// Negative, 0 or positive. std::string_view compares unsigned bytes.
int compare_values(std::string_view a, std::string_view b) {
  a = without_leading_zeros(a);
  b = without_leading_zeros(b);
  if (a.size() != b.size()) return a.size() < b.size() ? -1 : 1;
  return a.compare(b);
}

}  // namespace

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

std::vector<std::string_view> split_lines(std::string_view text) {
  text = without_byte_order_mark(text);
  if (text.ends_with('\n'))
    text.remove_suffix(1);
  else if (text.empty())
    return {};
  std::vector<std::string_view> lines = split(text, '\n');
  for (std::string_view& line : lines)
    if (line.ends_with('\r')) line.remove_suffix(1);
  return lines;
}

std::string shell_word(const std::string& word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=.,:/@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string text = "'";
  for (const char letter : word)
    text += letter == '\'' ? std::string("'\\''") : std::string(1, letter);
  return text + "'";
}

size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<size_t> before(b.size() + 1);
  std::vector<size_t> last(b.size() + 1);
  std::vector<size_t> now(b.size() + 1);
  std::iota(last.begin(), last.end(), size_t{0});
  for (size_t i = 1; i <= a.size(); ++i) {
    now[0] = i;
    for (size_t j = 1; j <= b.size(); ++j) {
      now[j] = std::min({last[j] + 1, now[j - 1] + 1, last[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        now[j] = std::min(now[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, now);
  }
  return last[b.size()];
}

std::string nearest(std::string_view word, const std::vector<std::string>& names) {
  return *std::ranges::min_element(
      names, {}, [&](const std::string& name) { return edit_distance(word, name); });
}

std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

bool is_utf8(const std::string& text) {
  try {
    (void)Json(text).dump();
    return true;
  } catch (const Json::type_error&) {
    return false;
  }
}

std::string_view without_byte_order_mark(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  return text;
}

std::string printable(std::string_view text) { return shown(text, true); }

std::string printable_line(std::string_view text) { return shown(text, false); }

std::string wrapped_line(const std::string& line, size_t width, size_t indent,
                         const std::string& end) {
  std::string text;
  std::string rest = line;
  size_t words = rest.find_first_not_of(' ');  // do not break the indentation
  while (rest.size() > width && words != std::string::npos) {
    size_t cut = rest.rfind(' ', width - end.size());
    if (cut == std::string::npos || cut < words) cut = rest.find(' ', words);
    const size_t next = cut == std::string::npos ? cut : rest.find_first_not_of(' ', cut);
    if (next == std::string::npos) break;
    text += rest.substr(0, rest.find_last_not_of(' ', cut) + 1) + end + "\n";
    rest = std::string(indent, ' ') + rest.substr(next);
    words = indent;
  }
  return text + rest;
}

std::string wrapped_command(const std::vector<std::string>& words) {
  constexpr size_t kColumns = 80 - 2;  // before " \\"
  std::string text = " ";
  size_t column = 1;
  for (const std::string& word : words) {
    if (column + 1 + word.size() > kColumns && column > 5) {
      text += " \\\n     ";
      column = 5;
    }
    text += " " + word;
    column += 1 + word.size();
  }
  return text;
}

size_t letter_start(std::string_view text, size_t at) {
  while (at > 0 && !starts_letter(text[at])) --at;
  return at;
}

std::string shortened(std::string_view text) {
  constexpr size_t kShown = 60;
  if (text.size() <= kShown) return printable_line(text);
  const std::string shown = printable_line(text.substr(0, letter_start(text, kShown)));
  return fmt::format("{}... ({} bytes)", shown, text.size());
}

std::string counted(uint64_t count, std::string_view noun, std::string_view plural) {
  if (count == 1) return fmt::format("1 {}", noun);
  return plural.empty() ? fmt::format("{} {}s", count, noun) : fmt::format("{} {}", count, plural);
}

bool natural_less(std::string_view a, std::string_view b) {
  bool fewer_zeros = false;
  bool decided = false;
  while (!a.empty() && !b.empty()) {
    if (is_digit(a.front()) && is_digit(b.front())) {
      const std::string_view number_a = consume_digits(a);
      const std::string_view number_b = consume_digits(b);
      const int order = compare_values(number_a, number_b);
      if (order != 0) return order < 0;
      if (!decided && number_a.size() != number_b.size()) {
        decided = true;
        fewer_zeros = number_a.size() < number_b.size();
      }
    } else {
      const int order = a.substr(0, 1).compare(b.substr(0, 1));
      if (order != 0) return order < 0;
      a.remove_prefix(1);
      b.remove_prefix(1);
    }
  }
  if (a.empty() && b.empty()) return fewer_zeros;
  return a.empty();
}

std::string csv_field(std::string_view text) {
  constexpr std::string_view kBlanks = " \t";
  const bool has_blank_end = !text.empty() && (kBlanks.find(text.front()) != std::string::npos ||
                                               kBlanks.find(text.back()) != std::string::npos);
  if (text.find_first_of(",\"\r\n") == std::string::npos && !text.starts_with('#') &&
      !has_blank_end)
    return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string html_escaped(std::string_view text) {
  // The JSON writer replaces invalid UTF-8.
  const std::string clean =
      Json::parse(Json(std::string(text)).dump(-1, ' ', false, Json::error_handler_t::replace))
          .get<std::string>();
  constexpr std::string_view kMarkup = "&<>\"'";
  constexpr std::array<std::string_view, 5> kReferences = {"&amp;", "&lt;", "&gt;", "&quot;",
                                                           "&#39;"};
  std::string escaped;
  for (const char c : clean) {
    const auto byte = static_cast<uint8_t>(c);
    const bool is_control = (byte < 32 && c != '\n' && c != '\t') || byte == 127;
    if (const size_t markup = kMarkup.find(c); markup != std::string_view::npos)
      escaped += kReferences[markup];
    else
      escaped += is_control ? "\xef\xbf\xbd" : std::string(1, c);
  }
  return escaped;
}

std::string base64(std::span<const std::byte> bytes) {
  constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t count = std::min<size_t>(3, bytes.size() - i);
    uint32_t group = 0;
    for (size_t k = 0; k < 3; ++k)
      group = group << 8 | (k < count ? static_cast<uint32_t>(bytes[i + k]) : 0);
    for (size_t k = 0; k < 4; ++k) text += k <= count ? kDigits[group >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

}  // namespace vpr
