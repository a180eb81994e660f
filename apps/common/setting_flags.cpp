#include "setting_flags.h"

#include <charconv>
#include <cmath>

#include "base/error.h"

namespace vpr {
namespace {

// Bytes from "512M", "2G", "1000000"; K, M, G are powers of 1024.
size_t parse_bytes(const std::string& text) {
  static const std::string kUnits = "KMG";
  size_t used = 0;
  unsigned long long value = 0;
  try {
    value = std::stoull(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  const size_t unit = used + 1 == text.size() ? kUnits.find(text[used]) : std::string::npos;
  const bool plain = used == text.size();
  if (used == 0 || text[0] == '-' || (!plain && unit == std::string::npos) ||
      value >> 32 >> 20 != 0)
    throw Error(ErrorKind::usage,
                fmt::format("{} takes bytes, as in 512M or 2G, found {}", kMemoryFlag, text));
  return plain ? value : value << (10 * (unit + 1));
}

}  // namespace

Json flag_value(const std::string& text) {
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  const char* end = text.data() + text.size();
  const auto parse = [&](auto value) -> std::optional<Json> {
    const auto [stop, error] = std::from_chars(begin, end, value);
    if (error != std::errc{} || stop != end) return std::nullopt;
    return Json(value);
  };
  if (const auto whole = parse(uint64_t{})) return *whole;
  if (const auto negative = parse(int64_t{})) return *negative;
  if (const auto real = parse(double{}); real && std::isfinite(real->get<double>())) return *real;
  return text;
}

Flag add_memory_flag(const Command& command, size_t& bytes, const std::string& help) {
  return command
      .add_option(
          kMemoryFlag, [&bytes](const std::string& text) { bytes = parse_bytes(text); },
          fmt::format("{} (default {}G)", help, bytes >> 30))
      .type_name("BYTES");
}

}  // namespace vpr
