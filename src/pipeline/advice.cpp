#include "pipeline/advice.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

namespace vpr {
namespace {

constexpr double kMostHits = 0.2;  // of all cells
constexpr size_t kSuggestedShare = 10;

// Numbers that a suggested threshold may be, apart from each other by 1 / this.
double steps_of(ThresholdScale scale) {
  switch (scale) {
    case ThresholdScale::relative:
    case ThresholdScale::mean:
      return 1000;
    case ThresholdScale::bits:
      return 10;
    case ThresholdScale::mean_z:
      break;
  }
  return 100;
}

double frame_value(const Result& result, const Match& match) {
  return result.score().frame_value(match.score, result.window_length());
}

// On the scale of the target's threshold.
double value_of(const Result& result, const Match& match) {
  const Target& target = result.targets[match.target];
  if (target.scale == ThresholdScale::bits || target.scale == ThresholdScale::mean_z)
    return frame_value(result, match);
  const double divisor = target.scale == ThresholdScale::mean ? target.window_means[match.query]
                                                              : target.max_distance.value_or(0);
  return divisor == 0 ? 0 : match.score / divisor;
}

std::vector<Match> best_matches(const Result& result) {
  std::vector<Match> found;
  for (const auto& match : result.best)
    if (match) found.push_back(*match);
  std::sort(found.begin(), found.end(), [&](const Match& a, const Match& b) {
    const double value_a = value_of(result, a);
    const double value_b = value_of(result, b);
    return value_a != value_b ? value_a < value_b : a.query < b.query;
  });
  return found;
}

double count_cells(const Result& result, size_t query_windows) {
  double train_windows = 0;
  for (const Target& target : result.targets)
    if (target.searched) train_windows += static_cast<double>(target.windows);
  return train_windows * static_cast<double>(query_windows);
}

std::string closest_text(const Result& result, const Match& match) {
  const Target& target = result.targets[match.target];
  const size_t length = result.window_length();
  std::string text = fmt::format(
      "The closest are query frame {} and {} frame {}: ", anchor_of(match.query, length),
      target.name, anchor_of(match.train, length));
  if (target.scale == ThresholdScale::mean_z)
    return text + fmt::format("mean z {:.2f}", value_of(result, match));
  if (target.scale == ThresholdScale::relative)
    text += fmt::format("{:.3f} of the largest distance, ", value_of(result, match));
  if (target.scale == ThresholdScale::mean)
    text +=
        fmt::format("{:.3f} of what this window differs by on average, ", value_of(result, match));
  return text + fmt::format("mean frame distance {:.1f}", frame_value(result, match));
}

std::optional<SuggestedThreshold> suggest(const Result& result, const std::vector<Match>& best) {
  const Target& target = result.targets[best.front().target];
  const double steps = steps_of(target.scale);
  const double reached = value_of(result, best[(best.size() - 1) / kSuggestedShare]);
  SuggestedThreshold suggested;
  suggested.scale = target.scale;
  suggested.threshold = (std::floor(reached * steps) + 1) / steps;
  if (target.scale == ThresholdScale::relative || target.scale == ThresholdScale::mean)
    suggested.threshold = std::min(suggested.threshold, 1.0);
  if (target.scale == ThresholdScale::mean_z)
    suggested.threshold = std::min(suggested.threshold, 0.0);
  for (const Match& match : best)
    if (value_of(result, match) < suggested.threshold) ++suggested.windows;
  if (suggested.windows == 0) return std::nullopt;
  return suggested;
}

}  // namespace

std::optional<ThresholdAdvice> threshold_advice(const Result& result) {
  const auto& settings = std::get<SequenceQuerySettings>(result.settings);
  if (decision_kind(settings.decision).accepts != nullptr) return margin_advice(result);
  const std::vector<Match> best = best_matches(result);
  if (best.empty()) return std::nullopt;
  const double share = static_cast<double>(result.hits.size()) / count_cells(result, best.size());
  ThresholdAdvice advice;
  advice.is_too_large = share > kMostHits;
  if (!advice.is_too_large && !result.hits.empty()) return std::nullopt;
  advice.suggested = suggest(result, best);
  const auto& used = result.targets[best.front().target].threshold;
  if (advice.is_too_large && advice.suggested && used && advice.suggested->threshold >= *used)
    advice.suggested.reset();
  advice.sentence =
      (advice.is_too_large
           ? fmt::format("{:.0f} % of all window pairs are hits: t_r is too large to tell places "
                         "apart. ",
                         100 * share)
           : std::string("Nothing is close enough. ")) +
      closest_text(result, best.front()) + ".";
  return advice;
}

}  // namespace vpr
