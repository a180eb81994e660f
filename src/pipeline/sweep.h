// A whole grid of settings for little more than the price of one query.
#pragma once

#include <functional>
#include <string>

#include "pipeline/fabmap_query.h"
#include "pipeline/query.h"
#include "pipeline/sweep_counts.h"

namespace vpr {

/// How to find the ground truth of a result: by the scope of its indices.
using TruthReader = std::function<GroundTruth(const GroundTruthScope&)>;

/// The counts that vpr-query and vpr-eval give for every cell, by window, then threshold, and which
/// cell to choose. Frame distances are computed once (twice with thresholds relative to the largest
/// distance): windows of all lengths come from the same pass, thresholds of one length from its
/// hits at the largest. `base`: the other settings. Each warning is said once. Throws as plan_query
/// does, and Error(usage) where the hits of all lengths do not fit into the memory together.
Sweep sweep_sequences(const SequenceDatabase& database, const DescriptorSet& query,
                      const std::string& query_name, const SequenceQuerySettings& base,
                      const Grid& grid, const TruthReader& read_truth,
                      const QueryResources& resources, const Monitor& monitor);

/// The same for FAB-MAP: from one pass of posteriors. Throws Error(usage) for settings out of
/// range, an automatic threshold, and the loop mode.
Sweep sweep_fabmap(const FabmapDatabase& database, const SequenceWords& query,
                   const std::string& query_name, const FabmapQuerySettings& base, const Grid& grid,
                   const TruthReader& read_truth, uint64_t seed, const Monitor& monitor);

}  // namespace vpr
