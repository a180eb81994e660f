#include "decide/result.h"

#include <limits>

#include "match/rates.h"

namespace vpr {

namespace {

// The recognitions of a decision by margin: best matches with at least the margin of their target.
void decide_by_margin(Result& result) {
  result.recognitions.clear();
  for (size_t window = 0; window < result.best.size(); ++window) {
    const auto& best = result.best[window];
    if (!best) continue;
    const std::optional<double> least = result.targets[best->target].margin;
    const std::optional<double> margin = frame_margin(result, window);
    if (least && margin && *margin >= *least) result.recognitions.push_back(*best);
  }
}

}  // namespace

ResultPath::ResultPath(size_t frames)
    : nowhere(frames, std::numeric_limits<double>::quiet_NaN()),
      rates(nowhere),
      tracks(frames, 0) {}

Result make_result(const QueryPlan& plan, const RecognitionScanResult& found,
                   const std::vector<std::optional<uint32_t>>& margins) {
  const int64_t offset = plan.score_offset();
  const auto match_of = [&](const Cell& cell) {
    return Match{cell.query_window, cell.sequence, cell.train_window, 0,
                 static_cast<double>(cell.score - offset)};
  };
  Result result;
  result.settings = plan.settings;
  result.query = plan.query_sequence;
  result.query_windows = plan.query_windows;
  result.targets = plan.sequences;
  result.statistics = plan.statistics;
  result.recognitions.reserve(found.recognitions.size());
  for (const Cell& recognition : found.recognitions)
    result.recognitions.push_back(match_of(recognition));
  for (const auto& best : found.best)
    result.best.push_back(best ? std::optional(match_of(*best)) : std::nullopt);
  const std::vector<Rate> rates = parse_rates(plan.settings.rates);
  for (size_t window = 0; !rates.empty() && window < found.best.size(); ++window) {
    const auto& best = found.best[window];
    result.best_rates.push_back(best ? ratio_of(rates[best->rate])
                                     : std::numeric_limits<double>::quiet_NaN());
  }
  result.margins.assign(margins.begin(), margins.end());
  if (plan.settings.decision == Decision::margin) decide_by_margin(result);
  return result;
}

std::optional<double> frame_margin(const Result& result, size_t query_window) {
  if (query_window >= result.margins.size() || !result.margins[query_window]) return std::nullopt;
  return result.score().frame_value(*result.margins[query_window], result.window_length());
}

void cluster(Result& result, const Monitor& monitor) {
  const auto& settings = std::get<SequenceQuerySettings>(result.settings);
  result.clusters = result.path ? cluster_tracks(result.recognitions, result.path->tracks)
                                : cluster_by_target(result.recognitions, result.targets.size(),
                                                    settings.clustering, monitor);
}

size_t recognized_windows(const Result& result) {
  size_t windows = 0;
  for (size_t h = 0; h < result.recognitions.size(); ++h)
    if (h == 0 || result.recognitions[h].query != result.recognitions[h - 1].query) ++windows;
  return windows;
}

}  // namespace vpr
