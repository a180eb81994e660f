#include "base/printable.h"

#include <cstdint>

#include <fmt/format.h>

#include "base/utf8.h"

namespace vpr {
namespace {

std::string shown(std::string_view text, bool keeps_line_feeds) {
  const bool is_text = is_utf8(std::string(text));
  const auto byte_at = [&](size_t i) { return static_cast<uint8_t>(text[i]); };
  std::string result;
  for (size_t i = 0; i < text.size(); ++i) {
    const uint8_t byte = byte_at(i);
    // U+0080 to U+009F are the bytes c2 80 to c2 9f.
    const bool is_first_of_c1 = byte == 0xc2 && i + 1 < text.size() && byte_at(i + 1) < 0xa0;
    const bool is_last_of_c1 = byte >= 0x80 && byte < 0xa0 && i > 0 && byte_at(i - 1) == 0xc2;
    const bool is_control = byte < 0x20 || byte == 0x7f || is_first_of_c1 || is_last_of_c1;
    const bool stays = byte == '\n' ? keeps_line_feeds : !is_control && (byte < 0x80 || is_text);
    result += stays ? std::string(1, text[i]) : fmt::format("\\x{:02x}", byte);
  }
  return result;
}

}  // namespace

std::string printable(std::string_view text) { return shown(text, true); }

std::string printable_line(std::string_view text) { return shown(text, false); }

}  // namespace vpr
