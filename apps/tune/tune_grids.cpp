// Grids of settings: lists of values on the command line, or defaults.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "tune.h"
#include "tune/trials.h"

namespace vpr {
namespace {

constexpr double kMostValues = 10'000;
constexpr const char* kWindowLengths = "5,10,20,40,80";
constexpr const char* kFabmapWindows = "1,2,3,5,8";
constexpr const char* kPlaceThresholds = "0.3:0.9:0.1,0.95,0.99,0.999";
// By ThresholdScale: relative, bits, mean-z.
constexpr std::array<const char*, 3> kDistanceThresholds = {"0.3:0.9:0.025", "100:490:15",
                                                            "-4:-0.5:0.125"};
constexpr const char* kDistanceMargins = "4:80:4,auto";
constexpr const char* kScoreMargins = "0.1:1.5:0.1,auto";

std::string value_or(const std::string& given, const char* standard) {
  return given.empty() ? standard : given;
}

double parse_number(std::string_view text, const std::string& flag) {
  const Json value = flag_value(std::string(text));
  if (!value.is_number())
    throw Error(ErrorKind::usage,
                "{} takes numbers, lists or ranges, as in 2,5,10 or 0.2:0.6:0.05, found \"{}\"",
                flag, text);
  return value.get<double>();
}

// A number or a range.
std::vector<double> parse_part(std::string_view part, const std::string& flag) {
  const auto range = split(part, ':');
  if (range.size() == 1) return {parse_number(part, flag)};
  const double first = parse_number(range[0], flag);
  const double last = parse_number(range[1], flag);
  const double step = range.size() > 2 ? parse_number(range[2], flag) : 1;
  const double count = std::floor((last - first) / step + 1e-9);
  if (range.size() > 3 || !(step > 0) || !(last >= first) || count > kMostValues)
    throw Error(ErrorKind::usage,
                "{}: a range is FIRST:LAST:STEP with at most {:.0f} values, found \"{}\"", flag,
                kMostValues, part);
  std::vector<double> numbers;
  for (int i = 0; i <= count; ++i) numbers.push_back(std::round((first + i * step) * 1e9) / 1e9);
  return numbers;
}

}  // namespace

std::vector<std::optional<double>> parse_values(const std::string& text, const std::string& flag,
                                                bool allow_auto) {
  std::vector<std::optional<double>> values;
  const auto add_once = [&](std::optional<double> value) {
    if (std::ranges::find(values, value) == values.end()) values.push_back(value);
  };
  for (const std::string_view part : split(text, ',')) {
    if (allow_auto && part == "auto")
      add_once(std::nullopt);
    else
      for (const double number : parse_part(part, flag)) add_once(number);
  }
  return values;
}

std::vector<uint64_t> parse_counts(const std::string& text, const std::string& flag) {
  std::vector<uint64_t> counts;
  for (const std::optional<double> value : parse_values(text, flag, false)) {
    if (!(*value >= 1 && *value <= 1e9) || *value != std::floor(*value))
      throw Error(ErrorKind::usage, "{} takes integers from 1 to 1000000000, found {:.16g}", flag,
                  *value);
    counts.push_back(static_cast<uint64_t>(*value));
  }
  return counts;
}

std::vector<uint64_t> window_lengths(const std::string& given, const char* standard,
                                     const SequenceDatabase& database, const DescriptorSet& query) {
  std::vector<uint64_t> lengths = parse_counts(value_or(given, standard), "--c-l");
  if (!given.empty()) return lengths;
  const std::vector<uint64_t> fitting = fitting_lengths(lengths, database, {&query});
  return fitting.empty() ? std::vector{lengths.front()} : fitting;
}

void add_sequence_grid(const Command& command, GridFlags& flags) {
  command.add_option(
      "--c-l", flags.windows,
      fmt::format("window lengths, as in 2,5,10 or 10:50:10; default: those of {} that fit",
                  kWindowLengths));
  command.add_option(
      "--t-r", flags.thresholds,
      fmt::format("thresholds, as in 0.2:0.6:0.05; negative --t-r=-3:-1:0.25; for raw distances "
                  "also auto (default: {}; in bits {}; for z-scores {})",
                  kDistanceThresholds[0], kDistanceThresholds[1], kDistanceThresholds[2]));
  command.add_option(
      "--margin", flags.margins,
      fmt::format("margins for --decide margin, as in 0.2:1:0.1,auto, where auto is the default "
                  "margin; in score per frame (default: {}; for z-scores {})",
                  kDistanceMargins, kScoreMargins));
}

Grid sequence_grid(const GridFlags& flags, const SequenceQuerySettings& settings,
                   const SequenceDatabase& database, const DescriptorSet& query) {
  const bool is_raw = settings.score == Score::raw;
  const char* thresholds = kDistanceThresholds[static_cast<size_t>(scale_of(settings))];
  return {window_lengths(flags.windows, kWindowLengths, database, query),
          settings.decision == Decision::margin
              ? parse_values(value_or(flags.margins, is_raw ? kDistanceMargins : kScoreMargins),
                             "--margin", true)
              : parse_values(value_or(flags.thresholds, thresholds), "--t-r", true)};
}

void add_fabmap_grid(const Command& command, GridFlags& flags) {
  command.add_option("--c-w", flags.windows,
                     fmt::format("windows, as in 1,3,5,8 (default: {})", kFabmapWindows));
  command.add_option(
      "--t-p", flags.thresholds,
      fmt::format("thresholds, as in 0.5:0.95:0.05,0.99 (default: {})", kPlaceThresholds));
}

Grid fabmap_grid(const GridFlags& flags) {
  return {parse_counts(value_or(flags.windows, kFabmapWindows), "--c-w"),
          parse_values(value_or(flags.thresholds, kPlaceThresholds), "--t-p", false)};
}

}  // namespace vpr
