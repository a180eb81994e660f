#include "setting_flags.h"

#include <charconv>
#include <cmath>

#include "base/error.h"
#include "decide/query_settings.h"

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

void add_score_settings(const Command& command, SequenceQuerySettings& settings,
                        const std::string& group) {
  const auto grouped = [&](Flag flag) { return group.empty() ? flag : flag.group(group); };
  grouped(
      add_setting(command, "--score", settings.score,
                  fmt::format("raw (distances), zscore (less the bias of frames that are close to "
                              "everything) or zscore-offline (from the whole query) (default: {})",
                              enum_name(settings.score))));
  grouped(command.add_list("--rates", settings.rates,
                           "windows of these rates, training frames for query frames, of which the "
                           "best counts, as in 1/2,2/3,1,3/2,2 (default 1)"))
      .comma_separated()
      .type_name("P/Q");
  grouped(add_setting(command, "--margin-width", settings.margin_width,
                      "elsewhere is more than so many frames before or behind the best match "
                      "(default: after how many a training sequence shows another place)"));
  grouped(command.add_list(
      "--same-place", settings.same_place,
      "A=B: these training sequences show the same place, so that neither is "
      "elsewhere for the other; repeatable; none: all differ (default: as found)"));
}

void add_decision_settings(const Command& command, SequenceQuerySettings& settings,
                           std::string& fabmap, const std::string& group) {
  const auto grouped = [&](Flag flag) { return group.empty() ? flag : flag.group(group); };
  grouped(add_setting(
      command, "--decide", settings.decision,
      "what is a recognition: threshold (default), every window pair closer than --t-r, or "
      "margin, the best match, if it is --margin better than the best one "
      "elsewhere"));
  grouped(add_setting(command, "--t-r-scale", settings.threshold_scale,
                      "scale of t_r: relative (D / max D) or bits (D / c_l); of zscore "
                      "scores mean-z (default: relative, mean-z)"));
  grouped(command.add_option("--fuse", fabmap,
                             "FAB-MAP's database of the same training sequences: what it says of "
                             "each frame is added to z-scores"));
  grouped(
      add_setting(command, "--fuse-beta", settings.fusion_weight,
                  "fusion weight, in standard deviations per nat, adapted online (default: 0.2)"));
}

void add_unreadable_flag(const Command& command, bool& skip_unreadable) {
  command.add_flag("--skip-unreadable", skip_unreadable,
                   "frames that can't be decoded keep their index and never match");
}

Flag add_memory_flag(const Command& command, size_t& bytes, const std::string& help) {
  return command
      .add_option(
          kMemoryFlag, [&bytes](const std::string& text) { bytes = parse_bytes(text); },
          fmt::format("{} (default {}G)", help, bytes >> 30))
      .type_name("BYTES");
}

}  // namespace vpr
