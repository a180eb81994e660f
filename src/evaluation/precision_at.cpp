#include "evaluation/precision_at.h"

#include <algorithm>

namespace vpr {
namespace {

bool is_judged(const QueryOutcome& query) {
  return query.has_match &&
         (query.verdict == Verdict::correct || query.verdict == Verdict::incorrect);
}

template <class Value>
std::optional<double> mean_of_judged(const Outcomes& outcomes, size_t k, const Value& value) {
  if (!outcomes.has_ranks || k > kMostRanked) return std::nullopt;
  double sum = 0;
  size_t judged = 0;
  for (const QueryOutcome& query : outcomes.queries) {
    if (!is_judged(query)) continue;
    ++judged;
    sum += value(query);
  }
  if (judged == 0) return std::nullopt;
  return sum / static_cast<double>(judged);
}

}  // namespace

std::optional<double> precision_at(const Outcomes& outcomes, size_t k) {
  return mean_of_judged(outcomes, k, [&](const QueryOutcome& query) {
    const auto right = std::ranges::count_if(query.right_ranks, [&](auto r) { return r <= k; });
    return static_cast<double>(right) / static_cast<double>(k);
  });
}

std::optional<double> mean_average_precision_at(const Outcomes& outcomes, size_t k) {
  return mean_of_judged(outcomes, k, [&](const QueryOutcome& query) {
    double sum = 0;
    size_t right = 0;
    for (const uint8_t rank : query.right_ranks)
      if (rank <= k) sum += static_cast<double>(++right) / static_cast<double>(rank);
    return sum / static_cast<double>(std::min<size_t>(k, std::max<size_t>(1, query.right_count)));
  });
}

}  // namespace vpr
