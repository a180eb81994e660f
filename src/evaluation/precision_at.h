// Precision@K and mAP@K: of the K best references, how many are right, and how early?
#pragma once

#include <optional>

#include "evaluation/outcomes.h"

namespace vpr {

/// The mean over judged queries of the share of right references among their K best, ties to the
/// first, references labelled ignore passed over (Manning, Raghavan, Schuetze 2008, chapter 8).
/// What is missing of K counts as wrong. K is 1 or more. None where there is no query to judge,
/// ranks are not known, or K is above kMostRanked.
std::optional<double> precision_at(const Outcomes& outcomes, size_t k);

/// The mean over judged queries of AP@K: the sum of precision@i over the i up to K whose reference
/// is right, divided by the right ones that K could hold, min(K, right references of the query)
/// (Weyand et al. 2020). Else as precision_at.
std::optional<double> mean_average_precision_at(const Outcomes& outcomes, size_t k);

}  // namespace vpr
