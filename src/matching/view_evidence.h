// How likely every view of a FAB-MAP database is by the words of a frame, in whole numbers.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "database/fused_views.h"
#include "matching/fabmap.h"

namespace vpr {

/// Whole numbers a nat.
inline constexpr int32_t kNatUnit = 1024;

/// FAB-MAP of a database as it is unless something else is set: Chow-Liu tree, P(z|e) = 0.39,
/// P(z|not e) = 0.
struct ViewEvidence {
  std::shared_ptr<const FusedViews> of;
  FabmapModel model;
  FabmapIndex index;
};

/// `views` is not null.
std::shared_ptr<const ViewEvidence> make_view_evidence(std::shared_ptr<const FusedViews> views);

/// The log-likelihood of every view in 1/1024 nat, rounded to the nearest, a half up; less
/// something that is the same for all views of the frame. From the fixed-point sums of
/// fabmap2_fixed_log_likelihoods, within 1e-4 nat and half a unit.
std::vector<int32_t> view_likelihoods(const ViewEvidence& evidence, const WordSet& words);

}  // namespace vpr
