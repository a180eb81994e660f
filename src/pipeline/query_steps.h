// The steps that a query and a sweep over many settings share.
#pragma once

#include <vector>

#include "matching/train_part.h"
#include "pipeline/query.h"

namespace vpr {

/// Throws Error(data) if database and query are described by different kinds, or by descriptors of
/// different lengths, Error(usage) if c_l is longer than what sums of such distances allow.
void check_descriptors(const DescriptorStore& trained, const DescriptorStore& asked,
                       uint64_t window_length);

/// The frame distances of the query to the training sequences. A sequence that is not searched has
/// no frames, so that indices stay the same; rows are centred over all sequences.
FrameDistances searched_distances(const QueryPlan& plan);

/// The runs of these frames, of all processes.
std::vector<FrameRun> searched_runs(const QueryPlan& plan);

/// What a process compares, and the distances of the frames that it holds.
struct OwnDistances {
  TrainPart part;
  FrameDistances frames;
};

/// The same, of several processes for this one's windows of up to `longest` frames; a step of all.
/// Throws Error(usage) where they can't share the plan.
OwnDistances own_distances(const QueryPlan& plan, size_t longest, const Share& share);

/// Whether limits depend on the largest distances.
bool needs_maxima(const QueryPlan& result);

/// The limits of thresholds relative to max(D), by sequence.
void set_relative_limits(QueryPlan& result, const std::vector<uint32_t>& maxima);

/// Stretches of similar frames in the query and the training sequences; none without a typical
/// distance.
std::optional<ResultViews> find_views(const QueryPlan& plan);

/// A scan for hits below the result's limits.
HitScanSettings scan_settings(const QueryPlan& result, const QueryResources& resources);

}  // namespace vpr
