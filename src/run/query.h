// A query by a sequence method: the block diagram of OpenABLE and FastABLE (paper, figure 1 B).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "run/plan.h"

namespace vpr {

/// A result, and the time of each step.
struct QueryRun {
  Result result;
  std::map<std::string, double> seconds;  ///< by step
  size_t verified_cells = 0;
};

/// Collects the rows of a planned query, which must outlive it, into a result: recognitions, best
/// matches and their margins, and the reports of the filter.
class ResultRows {
 public:
  ResultRows(const QueryPlan& plan, const QueryResources& resources);
  /// The sinks of the rows, valid as long as this object.
  Sinks sinks();
  /// The result without clusters and keyframes.
  Result result();

 private:
  void take_path(std::span<const ScoreRow> row);

  const QueryPlan& plan_;
  RecognitionScan recognitions_;
  std::optional<MarginScan> scan_;  ///< nullopt: the filter reports margins, or there are none
  std::vector<std::optional<uint32_t>> margins_;
  std::optional<ResultPath> path_;
};

/// Distances, recognitions, best matches and clusters of a planned query. Every row also goes to
/// `observers`. Throws Error(expectation) if a verified cell differs, and what match and scored
/// throw.
///
/// An approximate query finds recognitions and best matches among the windows that share a hash
/// bucket with a query window, with their exact distances. It has no rows and no margins, and it
/// reports the recall of the search. Throws Error(usage) for descriptors that are not binary.
QueryRun run_query(QueryPlan plan, const QueryResources& resources, const Sinks& observers,
                   const Monitor& monitor);

}  // namespace vpr
