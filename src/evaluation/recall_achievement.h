// Recall achievement rate: in how much of the route does recall reach what is asked for?
#pragma once

#include <array>
#include <optional>

#include "evaluation/outcomes.h"

namespace vpr {

/// Local recalls that are asked for, and frames of a stretch where nobody says otherwise.
inline constexpr std::array<double, 4> kRecallTargets = {0.5, 0.75, 0.9, 1.0};
inline constexpr size_t kRouteStretch = 25;

/// Recall@1 of one stretch of the path; none where it has no judged query with a match.
std::vector<std::optional<double>> local_recalls(const Outcomes& outcomes, size_t stretch_frames);

/// The share of stretches whose local recall@1 is `target` or more (Hussaini, Fischer, Milford
/// 2026). The path, all frames of the query, is cut into as many stretches as have about
/// `stretch_frames` (1 or more) frames each, at least one, as equally long as whole frames can be;
/// stretches without a judged query that has a match are left out. None where all are.
std::optional<double> recall_achievement(const std::vector<std::optional<double>>& recalls,
                                         double target);

}  // namespace vpr
