#include "run/advice.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "base/text.h"

namespace vpr {

namespace {

constexpr size_t kFewest = 4;  // one recognized frame in four is enough

// The median speed of the recognized frames; nullopt if no speed is known.
std::optional<double> recognized_rate(const Result& result) {
  std::vector<double> rates;
  for (const Match& recognition : result.recognitions)
    if (const auto rate = result.path->rates[recognition.query]) rates.push_back(*rate);
  if (rates.empty()) return std::nullopt;
  const auto middle = rates.begin() + static_cast<ptrdiff_t>(rates.size() / 2);
  std::nth_element(rates.begin(), middle, rates.end());
  return *middle;
}

// The result of the filter with default settings and the same training sequences.
Result filtered(const SequenceDatabase& database, const DescriptorSet& query,
                const SequenceQuerySettings& settings, const QueryResources& resources,
                const Monitor& monitor) {
  SequenceQuerySettings filter;
  filter.method = "filter";
  filter.only_sequences = settings.only_sequences;
  filter.same_place = settings.same_place;
  const Monitor silent = {{}, {}, monitor.stop};
  const QueryResources unverified = {resources.kernels, resources.memory_limit, 0, resources.seed};
  return run_query(plan_query(database, query, "", filter, unverified, silent), filter, unverified,
                   {}, silent)
      .result;
}

}  // namespace

std::optional<std::string> excess_advice(const Result& result) {
  constexpr double kMostShare = 0.2;
  std::vector<uint64_t> counts(result.sequences.size());
  for (const Match& recognition : result.recognitions) ++counts[recognition.sequence];
  const auto queries = static_cast<double>(
      std::ranges::count_if(result.best, [](const auto& best) { return best.has_value(); }));
  double largest = 0;
  size_t worst = 0;
  size_t excesses = 0;
  for (size_t s = 0; s < counts.size(); ++s) {
    const auto windows = static_cast<double>(result.sequences[s].windows);
    const double share = static_cast<double>(counts[s]) / (windows * queries);
    if (!result.sequences[s].threshold || !(share > kMostShare)) continue;
    ++excesses;
    if (share > largest) worst = s;
    largest = std::max(largest, share);
  }
  if (excesses == 0) return std::nullopt;
  return fmt::format(
      "t_r accepts {:.0f} % of the window pairs of {}{}: too many to tell places apart",
      100 * largest, result.sequences[worst].sequence.name,
      excesses == 1
          ? ""
          : ", and more than a fifth of " + counted(excesses - 1, "other training sequence"));
}

std::string no_recognition_advice(const Result& result) {
  const auto& settings = std::get<SequenceQuerySettings>(result.settings);
  if (settings.decision == Decision::threshold) {
    const bool has_threshold = std::ranges::any_of(
        result.sequences, [](const ComparedSequence& t) { return t.threshold.has_value(); });
    return has_threshold ? "Nothing is recognized: no score is below t_r."
                         : "Best matches only: a recognition needs --t-r, or --decide margin with "
                           "--margin.";
  }
  const bool has_margin =
      std::ranges::any_of(result.margins, [](const auto& margin) { return margin.has_value(); });
  return has_margin ? "Nothing is recognized: no best match has the margin."
                    : "Nothing is recognized: no training frame is outside the exclusion zone "
                      "(--exclusion-frames) of a best match. Use longer sequences.";
}

std::string filter_advice(const SequenceDatabase& database, const DescriptorSet& query,
                          const SequenceQuerySettings& settings, const QueryResources& resources,
                          const Monitor& monitor) {
  constexpr double kSameSpeed = 1.2;  // and its inverse
  const auto found = [](const Result& result) {
    return fmt::format("{} of {}", recognized_windows(result),
                       counted(result.query.frames, "frame"));
  };
  const Result forward = filtered(database, query, settings, resources, monitor);
  if (needs_advice(forward)) {
    const Result reversed =
        filtered(database, selected(query, at_speed("reversed", query.rows().size(), 1)), settings,
                 resources, monitor);
    if (!needs_advice(reversed))
      return fmt::format("In reverse order (--speed reversed), {} are recognized.",
                         found(reversed));
    return fmt::format(
        "At any speed, {} are recognized: {} may show another place,\nor the opposite direction.",
        found(forward), forward.recognitions.empty() ? "the query" : "the others");
  }
  const auto rate = recognized_rate(forward);
  const bool is_same_speed = !rate || (*rate <= kSameSpeed && *rate >= 1 / kSameSpeed);
  return fmt::format("The filter recognizes {}{}.\nUse --method filter without flags of windows.",
                     found(forward),
                     is_same_speed ? "" : fmt::format(", at about {:.1f} times the speed", *rate));
}

bool needs_advice(const Result& result) {
  return result.path ? kFewest * recognized_windows(result) < result.query.frames
                     : result.recognitions.empty();
}

}  // namespace vpr
