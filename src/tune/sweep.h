// Sweeps: counts for a grid of settings in about the time of one query.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "fabmap/place_query.h"
#include "run/query.h"
#include "truth/ground_truth.h"
#include "tune/calibration.h"
#include "tune/cell_counts.h"

namespace vpr {

/// 95 % intervals of the recognitions and clusters of a result, by the block bootstrap over query
/// windows. Blocks have c_l windows, because neighbors share most of their frames; for FAB-MAP they
/// have c_w frames, at least 8.
SweepIntervals count_intervals(const Result& result, const GroundTruth& truth, uint64_t seed);

/// The counts of vpr-query and vpr-eval for every cell, by window, then threshold, and the
/// recommended cell. Frame distances are computed once (twice for thresholds relative to the
/// largest distance): windows of all lengths come from the same pass, and the thresholds of one
/// length from its recognitions at the largest one. `base`: the other settings, resolved with the
/// feature sweep. Each warning is reported once. Throws as plan_query does, and Error(usage)
/// if the recognitions of all lengths together exceed the memory limit.
Sweep sweep_sequences(const SequenceDatabase& database, const DescriptorSet& query,
                      const std::string& query_name, const ResolvedSettings& base, const Grid& grid,
                      const TruthReader& read_truth, const QueryResources& resources,
                      const Monitor& monitor);

/// The counts for FAB-MAP, from one pass of posteriors. Throws Error(usage) for settings out of
/// range and loop queries.
Sweep sweep_fabmap(const FabmapDatabase& database, const SequenceWords& query,
                   const std::string& query_name, const FabmapQuerySettings& base, const Grid& grid,
                   const TruthReader& read_truth, uint64_t seed, const Monitor& monitor);

}  // namespace vpr
