// A query by a sequence method: the block diagram of OpenABLE and FastABLE (paper, figure 1 B).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "query/path_decisions.h"
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

/// Collects the reports of a planned query by the filter, which must outlive it, into a result.
class PathRows {
 public:
  explicit PathRows(const QueryPlan& plan);
  void operator()(std::span<const ScoreRow> row);
  Result result();

 private:
  void decide(const std::vector<Cell>& recognized, size_t frame);

  const QueryPlan& plan_;
  PathDecisions decisions_;
  std::vector<PathReport> steps_;     ///< by query frame, without matches
  std::vector<PathReport> reversed_;  ///< the same against the direction
  RecognitionScanResult found_;
  ResultPath path_;
  std::optional<WitnessStage> witness_;
  ResultPath::Decided by_margin_;  ///< the last report, with a witness
};

/// Collects the rows of a planned query, which must outlive it, into a result: recognitions, best
/// matches and their margins, and the reports of the filter.
class ResultRows {
 public:
  explicit ResultRows(const QueryPlan& plan);
  /// The sinks of the rows, valid as long as this object.
  Sinks sinks();
  /// The result without clusters and keyframes.
  Result result();

 private:
  const QueryPlan& plan_;
  RecognitionScan recognitions_;
  std::optional<MarginScan> scan_;  ///< nullopt: there are no margins, or the filter reports them
  std::optional<PathRows> paths_;   ///< of the filter
};

/// Distances, recognitions, best matches and clusters of a planned query. Every row also goes to
/// `observers`. Throws as match does.
///
/// An approximate query finds recognitions and best matches among the windows that share a hash
/// bucket with a query window, with their exact distances. It has no rows and no margins, and it
/// reports the recall of the search. Throws Error(usage) for descriptors that are not binary.
QueryRun run_query(QueryPlan plan, const Sinks& observers, const Monitor& monitor);

}  // namespace vpr
