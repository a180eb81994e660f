#include "evaluation/recall_achievement.h"

#include <algorithm>

#include "evaluation/recall_at.h"

namespace vpr {

std::vector<std::optional<double>> local_recalls(const Outcomes& outcomes, size_t stretch_frames) {
  const size_t frames = outcomes.query_frames;
  const size_t count = std::max<size_t>(1, (frames + stretch_frames / 2) / stretch_frames);
  std::vector<size_t> found(count);
  std::vector<size_t> judged(count);
  for (const QueryOutcome& query : outcomes.queries) {
    if (query.verdict == Verdict::unreadable || query.verdict == Verdict::ignored) continue;
    if (!query.has_match) continue;
    // The stretch s holds frames from floor(s * frames / count) on.
    const size_t stretch = ((query.frame + 1) * count - 1) / frames;
    ++judged[stretch];
    if (is_found_at(query, 1)) ++found[stretch];
  }
  std::vector<std::optional<double>> recalls(count);
  for (size_t s = 0; s < count; ++s)
    if (judged[s] > 0) recalls[s] = static_cast<double>(found[s]) / static_cast<double>(judged[s]);
  return recalls;
}

std::optional<double> recall_achievement(const std::vector<std::optional<double>>& recalls,
                                         double target) {
  size_t known = 0;
  size_t achieved = 0;
  for (const auto& recall : recalls) {
    if (!recall) continue;
    ++known;
    achieved += *recall >= target;
  }
  if (known == 0) return std::nullopt;
  return static_cast<double>(achieved) / static_cast<double>(known);
}

}  // namespace vpr
