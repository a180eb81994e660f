// Recall@K.
#pragma once

#include <optional>

#include "evaluation/outcomes.h"

namespace vpr {

/// Whether a judged query has a correct reference among its K best.
bool is_found_at(const QueryOutcome& query, size_t k);

/// The share of judged queries that have a correct reference among their K best, ties to the first,
/// references labelled ignore passed over (queries without a match are left out). K = 1 needs best
/// matches only. None where there is no query to judge, or K > 1 and ranks are not known.
std::optional<double> recall_at(const Outcomes& outcomes, size_t k);

}  // namespace vpr
