// A query by a sequence method: the block diagram of OpenABLE and FastABLE (paper, figure 1 B).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "query/plan.h"

namespace vpr {

/// A result, and the time of each step.
struct QueryRun {
  Result result;
  std::map<std::string, double> seconds;  ///< by step
};

/// The frame distances of the query to all training frames; windows lie in the sequences that are
/// searched.
FrameDistances searched_distances(const QueryPlan& plan);

/// The settings of a scan for recognitions below the limits of a plan.
RecognitionScanSettings scan_settings(const QueryPlan& plan);

/// A cell of a planned query, as in results.
Match match_of(const Cell& cell, const QueryPlan& plan);

/// Whether a best match has the margin of its training sequence. `margin`: in score per frame.
bool has_margin(const Result& result, const Match& best, std::optional<double> margin);

/// The result of a plan without clusters: recognitions, best matches and their margins. By margin,
/// the recognitions are those of the best matches that have it; otherwise those of `found`.
Result make_result(const QueryPlan& plan, const RecognitionScanResult& found,
                   const std::vector<std::optional<uint32_t>>& margins);

/// Distances, recognitions, best matches and clusters of a planned query. Every row also goes to
/// `observers`. Throws as match does.
///
/// An approximate query finds recognitions and best matches among the windows that share a hash
/// bucket with a query window, with their exact distances. It has no rows and no margins, and it
/// reports the recall of the search. Throws Error(usage) for descriptors that are not binary.
QueryRun run_query(QueryPlan plan, const Sinks& observers, const Monitor& monitor);

}  // namespace vpr
