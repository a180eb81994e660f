#include "report/html_text.h"

#include <cassert>
#include <cstdint>

#include "base/json.h"

namespace vpr {

std::string html_escaped(std::string_view text) {
  // The JSON writer knows UTF-8: what it would replace is replaced here, too.
  const std::string clean =
      Json::parse(Json(std::string(text)).dump(-1, ' ', false, Json::error_handler_t::replace))
          .get<std::string>();
  std::string escaped;
  for (const char c : clean) {
    const auto byte = static_cast<uint8_t>(c);
    if (c == '&')
      escaped += "&amp;";
    else if (c == '<')
      escaped += "&lt;";
    else if (c == '>')
      escaped += "&gt;";
    else if (c == '"')
      escaped += "&quot;";
    else if (c == '\'')
      escaped += "&#39;";
    else if ((byte < 32 && c != '\n' && c != '\t') || byte == 127)
      escaped += "\xef\xbf\xbd";
    else
      escaped += c;
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

std::string script_json(const Json& json) {
  std::string text;
  for (const char c : json.dump(-1, ' ', true, Json::error_handler_t::replace))
    text += c == '<' ? "\\u003c" : std::string(1, c);
  return text;
}

std::string fill_page(std::string_view page, const std::map<std::string, std::string>& parts) {
  std::string filled;
  for (;;) {
    const size_t begin = page.find("{{");
    const size_t end = begin == std::string_view::npos ? begin : page.find("}}", begin);
    if (end == std::string_view::npos) return filled.append(page);
    filled.append(page.substr(0, begin));
    const auto part = parts.find(std::string(page.substr(begin + 2, end - begin - 2)));
    assert(part != parts.end());
    if (part != parts.end()) filled += part->second;
    page.remove_prefix(end + 2);
  }
}

}  // namespace vpr
