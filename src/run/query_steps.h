// The steps that a query and a sweep over many settings share.
#pragma once

#include <vector>

#include "run/query.h"

namespace vpr {

/// Throws Error(data) if database and query are described by different kinds, or by descriptors of
/// different lengths, Error(usage) if c_l is longer than what sums of such distances allow.
void check_descriptors(const DescriptorStore& trained, const DescriptorStore& asked,
                       uint64_t window_length);

/// The frame distances of the query to all training frames; windows lie in the sequences that are
/// searched.
FrameDistances searched_distances(const QueryPlan& plan);

/// Whether limits depend on the largest distances.
bool needs_maxima(const QueryPlan& result);

/// The limits of thresholds relative to max(D), by sequence.
void set_relative_limits(QueryPlan& result, const std::vector<uint32_t>& maxima);

/// Stretches of similar frames in the query and the training sequences; none without a typical
/// distance.
std::optional<ResultViews> find_views(const QueryPlan& plan);

/// What a result needs of the rows of a planned query, which must outlive it: recognitions, best
/// matches and their margins, and the reports of the filter.
class ResultRows {
 public:
  ResultRows(const QueryPlan& plan, const QueryResources& resources);
  /// What takes the rows, for as long as this lives.
  Sinks sinks();
  /// Without clusters and views.
  Result result();

 private:
  void take_path(std::span<const ScoreRow> row);

  const QueryPlan& plan_;
  RecognitionScan recognitions_;
  std::optional<MarginScan> scan_;  ///< none: the filter reports margins, or there are none
  std::vector<std::optional<uint32_t>> margins_;
  std::optional<ResultPath> path_;
};

/// What matchers take of a plan.
MatchSettings match_settings(const QueryPlan& plan, const QueryResources& resources);

/// A scan for recognitions below the result's limits.
RecognitionScanSettings scan_settings(const QueryPlan& result, const QueryResources& resources);

}  // namespace vpr
