#include "evaluation/recall_at.h"

#include <algorithm>

namespace vpr {

std::optional<double> recall_at(const Outcomes& outcomes, size_t k) {
  const uint64_t judged = judged_queries(outcomes);
  if (judged == 0 || (k > 1 && !outcomes.has_ranks)) return std::nullopt;
  const auto is_found = [&](const QueryOutcome& query) {
    if (!query.has_match) return false;
    return query.verdict == Verdict::correct ||
           (query.verdict == Verdict::incorrect && query.rank && *query.rank <= k);
  };
  const auto found = std::count_if(outcomes.queries.begin(), outcomes.queries.end(), is_found);
  return static_cast<double>(found) / static_cast<double>(judged);
}

}  // namespace vpr
