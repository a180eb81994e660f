// A whole grid of settings for little more than the price of one query.
#pragma once

#include <optional>
#include <vector>

#include "evaluation/sweep.h"
#include "pipeline/fabmap_query.h"
#include "pipeline/query.h"
#include "report/sweep_file.h"

namespace vpr {

/// Windows c_l by thresholds t_r.
struct SequenceGrid {
  std::vector<uint64_t> window_lengths;                    ///< c_l
  std::vector<std::optional<double>> distance_thresholds;  ///< t_r; none: automatic
};

/// How to find the ground truth of a result: by the scope of its indices.
using TruthReader = std::function<GroundTruth(const GroundTruthScope&)>;

/// The counts that vpr-query and vpr-eval give for every cell, by c_l, then t_r. Frame distances
/// are computed once (twice with thresholds relative to the largest distance): windows of all
/// lengths come from the same pass, thresholds of one length from its hits at the largest. `base`:
/// the other settings. Each warning is said once. Throws as plan_query does, and Error(usage) where
/// the hits of all lengths do not fit into the memory together.
std::vector<SequenceCellCounts> sweep_sequences(
    const SequenceDatabase& database, const DescriptorSet& query, const std::string& query_name,
    const SequenceQuerySettings& base, const SequenceGrid& grid, const TruthReader& read_truth,
    const QueryResources& resources, const Monitor& monitor);

/// 95 % intervals of the hits of one cell, by the block bootstrap over query windows: blocks of c_l
/// windows, for neighbours share most of their frames.
SweepIntervals sequence_intervals(const SequenceDatabase& database, const DescriptorSet& query,
                                  const SequenceQuerySettings& settings,
                                  const TruthReader& read_truth, const QueryResources& resources,
                                  const Monitor& monitor);

/// Windows c_w by thresholds t_p.
struct FabmapGrid {
  std::vector<uint64_t> windows;         ///< c_w
  std::vector<double> place_thresholds;  ///< t_p
};

/// The same for FAB-MAP, by c_w, then t_p: from one pass of posteriors.
std::vector<FabmapCellCounts> sweep_fabmap(const FabmapDatabase& database,
                                           const SequenceWords& query,
                                           const std::string& query_name,
                                           const FabmapQuerySettings& base, const FabmapGrid& grid,
                                           const TruthReader& read_truth, uint64_t seed,
                                           const Monitor& monitor);

/// The same intervals for FAB-MAP: blocks of c_w frames, but at least 8.
SweepIntervals fabmap_intervals(const FabmapDatabase& database, const SequenceWords& query,
                                const FabmapQuerySettings& settings, const TruthReader& read_truth,
                                uint64_t seed, const Monitor& monitor);

}  // namespace vpr
