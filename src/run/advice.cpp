#include "run/advice.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "base/text.h"
#include "match/match.h"

namespace vpr {

namespace {

// The median speed of the recognized frames; nullopt if no speed is known.
std::optional<double> recognized_rate(const Result& result) {
  std::vector<double> rates;
  for (const Match& recognition : result.recognitions)
    if (const double rate = result.path->rates[recognition.query]; !std::isnan(rate))
      rates.push_back(rate);
  if (rates.empty()) return std::nullopt;
  const auto middle = rates.begin() + static_cast<ptrdiff_t>(rates.size() / 2);
  std::nth_element(rates.begin(), middle, rates.end());
  return *middle;
}

}  // namespace

std::optional<std::string> excess_advice(const Result& result) {
  constexpr double kMostShare = 0.2;
  double train_windows = 0;
  for (const ComparedSequence& compared : result.sequences)
    if (compared.searched) train_windows += static_cast<double>(compared.windows);
  const auto queries = static_cast<double>(
      std::ranges::count_if(result.best, [](const auto& best) { return best.has_value(); }));
  const double share = static_cast<double>(result.recognitions.size()) / (train_windows * queries);
  if (!(share > kMostShare)) return std::nullopt;
  return fmt::format(
      "{:.0f} % of all window pairs are recognitions: t_r is too large to tell places apart",
      100 * share);
}

std::string no_recognition_advice(const Result& result) {
  const auto& settings = std::get<SequenceQuerySettings>(result.settings);
  if (result.path)
    return "Nothing is recognized: the query may show another place or the opposite direction.";
  if (settings.decision == Decision::threshold) {
    const bool has_threshold = std::ranges::any_of(
        result.sequences, [](const ComparedSequence& t) { return t.threshold.has_value(); });
    return has_threshold ? "Nothing is recognized: no score is below t_r."
                         : "Without a threshold there are no recognitions, only best matches.";
  }
  const bool has_margin =
      std::ranges::any_of(result.margins, [](const auto& margin) { return margin.has_value(); });
  return has_margin ? "Nothing is recognized: no best match has the margin."
                    : "Nothing is recognized: no training frame is outside the exclusion zone "
                      "(--exclusion-frames) of a best match. Train longer sequences.";
}

std::string filter_advice(const SequenceDatabase& database, const DescriptorSet& query,
                          const SequenceQuerySettings& settings, const QueryResources& resources,
                          const Monitor& monitor) {
  constexpr size_t kFewest = 4;       // one frame in four is enough to suggest the filter
  constexpr double kSameSpeed = 1.2;  // and its inverse
  SequenceQuerySettings filter;
  filter.method = "filter";
  filter.only_sequences = settings.only_sequences;
  filter.same_place = settings.same_place;
  const Monitor silent = {{}, {}, monitor.stop};
  const QueryResources unverified = {resources.kernels, resources.memory_limit, 0, resources.seed};
  const Result result =
      run_query(plan_query(database, query, "", filter, unverified, silent), unverified, {}, silent)
          .result;
  if (result.recognitions.empty())
    return "Nothing is recognized at any speed: the query may show another place or the opposite "
           "direction.";
  const size_t recognized = recognized_windows(result);
  const std::string found =
      fmt::format("{} of {}", recognized, counted(result.query.frames, "frame"));
  if (kFewest * recognized < result.query.frames)
    return fmt::format(
        "Only {} are recognized at any speed (--method filter): most of the query may show another "
        "place or the opposite direction.",
        found);
  const auto rate = recognized_rate(result);
  if (rate && (*rate > kSameSpeed || *rate < 1 / kSameSpeed))
    return fmt::format(
        "At another speed (about {:.1f} training frames per query frame) {} are recognized: use "
        "--method filter.",
        *rate, found);
  return fmt::format("The filter recognizes {}: use --method filter.", found);
}

}  // namespace vpr
