#include "tune_grids.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/error.h"
#include "number_lists.h"
#include "run/train.h"

namespace vpr {
namespace {

constexpr const char* kWindowLengths = "5,10,20,40,80";
constexpr const char* kCalibratedLengths = "10,20,40";
constexpr const char* kFabmapWindows = "1,2,3,5,8";
constexpr const char* kPlaceThresholds = "0.3:0.9:0.1,0.95,0.99,0.999";

// By ThresholdScale: relative, bits, mean-z.
constexpr std::array<const char*, 3> kDistanceThresholds = {"0.3:0.9:0.025", "100:490:15",
                                                            "-4:-0.5:0.125"};

// Of raw distances, and of z-scores.
constexpr const char* kDistanceMargins = "4:80:4,auto";
constexpr const char* kScoreMargins = "0.1:1.5:0.1,auto";

std::string given_or(const std::string& given, const char* otherwise) {
  return given.empty() ? otherwise : given;
}

// Those that are no usage error for this query.
std::vector<uint64_t> fitting_windows(const char* lengths_text, const SequenceDatabase& database,
                                      const DescriptorSet& query) {
  const std::vector<DescriptorSpan> spans = descriptor_spans(database);
  const std::vector<FrameRun> query_runs = readable_runs(query.span());
  std::vector<uint64_t> lengths = parse_counts(lengths_text, "--c-l");
  const uint64_t shortest = lengths.front();
  std::erase_if(lengths, [&](uint64_t length) {
    return count_windows(query_runs, length) == 0 ||
           std::all_of(spans.begin(), spans.end(), [&](const DescriptorSpan& span) {
             return count_windows(readable_runs(span), length) == 0;
           });
  });
  return lengths.empty() ? std::vector{shortest} : lengths;
}

std::vector<std::optional<double>> swept_thresholds(const GridFlags& flags,
                                                    const SequenceQuerySettings& settings) {
  const bool by_margin = settings.decision == Decision::margin;
  const char* margins = settings.score == Score::raw ? kDistanceMargins : kScoreMargins;
  if (by_margin) return parse_thresholds(given_or(flags.margins, margins), "--margin");
  const char* thresholds = kDistanceThresholds[static_cast<size_t>(scale_of(settings))];
  return parse_thresholds(given_or(flags.thresholds, thresholds), "--t-r");
}

}  // namespace

Grid sequence_grid(const GridFlags& flags, const SequenceQuerySettings& settings,
                   const SequenceDatabase& database, const DescriptorSet& query) {
  return {flags.windows.empty() ? fitting_windows(kWindowLengths, database, query)
                                : parse_counts(flags.windows, "--c-l"),
          swept_thresholds(flags, settings)};
}

std::vector<uint64_t> calibrated_lengths(const std::string& windows,
                                         const SequenceDatabase& database,
                                         const DescriptorSet& query) {
  return windows.empty() ? fitting_windows(kCalibratedLengths, database, query)
                         : parse_counts(windows, "--c-l");
}

Grid fabmap_grid(const GridFlags& flags) {
  Grid grid{parse_counts(given_or(flags.windows, kFabmapWindows), "--c-w"), {}};
  for (const double t_p : parse_numbers(given_or(flags.thresholds, kPlaceThresholds), "--t-p"))
    grid.thresholds.emplace_back(t_p);
  return grid;
}

std::string window_length_help() {
  return fmt::format("window lengths, as in 2,5,10 or 10:50:10 (default: those of {} that fit)",
                     kWindowLengths);
}

std::string calibrated_lengths_help() {
  return fmt::format(
      "window lengths, of which the shortest is taken that recognizes nearly most, as in 10,20 "
      "(default: those of {} that fit)",
      kCalibratedLengths);
}

std::string distance_threshold_help() {
  return fmt::format(
      "thresholds, as in 0.2:0.6:0.05 or --t-r=-3:-1:0.25; the word auto may be one "
      "of them, of raw distances (default: {}; in bits {}; of z-scores {})",
      kDistanceThresholds[0], kDistanceThresholds[1], kDistanceThresholds[2]);
}

std::string margin_help() {
  return fmt::format(
      "with --decide margin, margins in score a frame, as in 0.2:1:0.1; the word auto may be one "
      "of them (default: {}; of z-scores {})",
      kDistanceMargins, kScoreMargins);
}

std::string fabmap_window_help() {
  return fmt::format("windows, as in 1,3,5,8 (default {})", kFabmapWindows);
}

std::string place_threshold_help() {
  return fmt::format("thresholds, as in 0.5:0.95:0.05,0.99 (default {})", kPlaceThresholds);
}

}  // namespace vpr
