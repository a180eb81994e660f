#include "present/result_text.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/text.h"
#include "match/lsh.h"

namespace vpr {
namespace {

// "0.725", or "0.61 to 0.64 (automatic)" over the searched sequences.
template <auto kMember>
std::string limit_text(const Result& result, bool is_automatic, std::string_view unit = "") {
  std::vector<double> limits;
  for (const ComparedSequence& compared : result.sequences)
    if (compared.searched && compared.*kMember) limits.push_back(*(compared.*kMember));
  if (limits.empty()) return "none";
  const auto [low, high] = std::ranges::minmax(limits);
  std::string text = fmt::format("{:.3g}", low);
  if (fmt::format("{:.3g}", high) != text) text += fmt::format(" to {:.3g}", high);
  if (!unit.empty()) text += fmt::format(" {}", unit);
  return is_automatic ? text + " (automatic)" : text;
}

bool has_threshold(const ComparedSequence& compared) {
  return compared.searched && compared.threshold;
}

std::string threshold_text(const Result& result, const SequenceQuerySettings& settings) {
  const auto searched = std::ranges::find_if(result.sequences, has_threshold);
  if (searched == result.sequences.end()) return "best matches only";
  const std::string limit =
      limit_text<&ComparedSequence::threshold>(result, !limit_of(settings.rule));
  return fmt::format("t_r {} {}", limit, enum_name(searched->scale));
}

std::string settings_text(const Result& result, const SequenceQuerySettings& settings) {
  const Rule& rule = settings.rule;
  std::string text = method_text(settings);
  if (!has_paths(rule)) text += fmt::format(", c_l {}", window_length_of(rule));
  const bool has_margin = decision_of(rule) == Decision::margin;
  return text + ", " +
         (has_margin ? "margin " + limit_text<&ComparedSequence::margin>(result, !limit_of(rule),
                                                                         result.score().margin_unit)
                     : threshold_text(result, settings));
}

std::string settings_text(const Result&, const FabmapQuerySettings& settings) {
  return fmt::format("{} ({}), t_p {:g}, c_w {}", method_text(settings), settings.variant,
                     settings.place_threshold, settings.window);
}

// "64-137", or "64" for a single frame.
std::string windows_text(size_t first, size_t last) {
  return first == last ? std::to_string(first) : fmt::format("{}-{}", first, last);
}

// "1.0x", or "1.0x in time; 0.27 frames per frame" if the sequences have other rates. `rate`:
// training per query frames.
std::string speed_text(double rate, const Sequence& query, const Sequence& train) {
  if (!query.fps || !train.fps || *query.fps == *train.fps) return fmt::format("{:.1f}x", rate);
  return fmt::format("{:.1f}x in time; {:.2f} frames per frame", rate * *query.fps / *train.fps,
                     rate);
}

// "margin 9.1, contrast 1.7: features decide" for the first recognized frame of a path, or "margin
// 31.0: whole frames decide" if features were not compared; empty without a witness.
std::string witness_text(const Result& result, size_t query_frame) {
  if (!result.path || result.path->witnessed.empty()) return "";
  const auto& decided = result.path->witnessed[query_frame];
  if (!decided) return "";
  const double least = limit_of(std::get<SequenceQuerySettings>(result.settings).rule).value_or(0);
  return fmt::format("margin {:.1f}{}: {} decide", decided->margin,
                     decided->contrast ? fmt::format(", contrast {:.1f}", *decided->contrast) : "",
                     decided->margin < least ? "features" : "whole frames");
}

// Both, or the one that is not empty.
std::string joined(const std::string& a, const std::string& b) {
  return a.empty() || b.empty() ? a + b : a + ", " + b;
}

std::vector<RecognizedRange> cluster_ranges(const Result& result) {
  std::vector<RecognizedRange> ranges;
  const size_t length = result.window_length();
  for (const Cluster& cluster : result.clusters->all) {
    const size_t first = anchor_of(cluster.train_first, length);
    const size_t last = anchor_of(cluster.train_last, length);
    const Sequence& train = result.sequences[cluster.sequence].sequence;
    const auto rate = mean_rate(cluster);
    ranges.push_back({anchor_of(cluster.query_first, length), anchor_of(cluster.query_last, length),
                      fmt::format("{} {}", train.name, windows_text(first, last)),
                      joined(rate ? speed_text(*rate, result.query, train) : "",
                             witness_text(result, cluster.query_first))});
  }
  for (uint32_t i = 0; i < result.recognitions.size(); ++i)
    ranges[result.clusters->of_recognition[i]].recognitions.push_back(i);
  return ranges;
}

std::vector<RecognizedRange> place_ranges(const Result& result) {
  const ResultPlaces& places = *result.places;
  const bool is_frame_a_place = places.names.size() == places.views;
  std::vector<RecognizedRange> ranges;
  for (const PlaceStretch& run : is_frame_a_place ? place_runs(result.recognitions, 2, 2)
                                                  : place_runs(result.recognitions, 1, 0)) {
    std::string train = places.names[run.first_place];
    if (run.last_place != run.first_place) train += " to " + places.names[run.last_place];
    ranges.push_back({run.first_frame, run.last_frame, std::move(train),
                      fmt::format("p {:.3f}", run.probability), run.recognitions});
  }
  return ranges;
}

}  // namespace

std::string method_text(const QuerySettings& settings) {
  const auto* sequences = std::get_if<SequenceQuerySettings>(&settings);
  if (sequences == nullptr) return "FAB-MAP";
  const Rule& rule = sequences->rule;
  if (has_paths(rule)) return "filter";
  if (is_zscore(rule)) return "z-score windows";
  const std::string& method = method_of(rule);
  return method == "openable" ? "OpenABLE" : method == kLshMethod ? "FastABLE by LSH" : "FastABLE";
}

std::string settings_text(const Result& result) {
  return std::visit([&](const auto& settings) { return settings_text(result, settings); },
                    result.settings);
}

bool has_rule(const Result& result) {
  const auto* settings = std::get_if<SequenceQuerySettings>(&result.settings);
  return settings == nullptr || decision_of(settings->rule) == Decision::margin ||
         std::ranges::any_of(result.sequences, has_threshold);
}

std::vector<RecognizedRange> recognized_ranges(const Result& result) {
  std::vector<RecognizedRange> ranges =
      result.places ? place_ranges(result) : cluster_ranges(result);
  std::ranges::stable_sort(ranges, {}, &RecognizedRange::query_first);
  return ranges;
}

std::string range_text(const Result& result, const RecognizedRange& range) {
  return joined(fmt::format("{} {} = {}", result.query.name,
                            windows_text(range.query_first, range.query_last), range.train),
                range.score);
}

std::string ranges_text(const Result& result, std::vector<RecognizedRange> ranges, size_t most,
                        const std::string& noun) {
  const size_t all = ranges.size();
  const auto length = [](const RecognizedRange& range) {
    return range.query_last - range.query_first;
  };
  const auto is_correct = [](const RecognizedRange& range) { return range.verdict.empty(); };
  if (all > most) {
    std::ranges::stable_sort(ranges, std::ranges::greater{}, length);
    std::ranges::stable_sort(ranges.begin() + 1, ranges.end(), {}, is_correct);
    ranges.resize(most);
    std::ranges::stable_sort(ranges, {}, &RecognizedRange::query_first);
  }
  std::string text;
  for (const RecognizedRange& range : ranges)
    text += fmt::format("  {}{}\n", range_text(result, range), range.verdict);
  if (all > most) text += fmt::format("  and {} (-v lists all)\n", counted(all - most, noun));
  return text;
}

}  // namespace vpr
