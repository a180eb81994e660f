#include "evaluation/recall_at.h"

#include <algorithm>

namespace vpr {

bool is_found_at(const QueryOutcome& query, size_t k) {
  if (!query.has_match) return false;
  return query.verdict == Verdict::correct ||
         (query.verdict == Verdict::incorrect && query.rank && *query.rank <= k);
}

std::optional<double> recall_at(const Outcomes& outcomes, size_t k) {
  const uint64_t judged = judged_queries(outcomes);
  if (judged == 0 || (k > 1 && !outcomes.has_ranks)) return std::nullopt;
  const auto found =
      std::count_if(outcomes.queries.begin(), outcomes.queries.end(),
                    [&](const QueryOutcome& query) { return is_found_at(query, k); });
  return static_cast<double>(found) / static_cast<double>(judged);
}

}  // namespace vpr
