// A query by a sequence method: the block diagram of OpenABLE and FastABLE (paper, figure 1 B).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "decide/path_decisions.h"
#include "run/plan.h"

namespace vpr {

/// A result, and the time of each step.
struct QueryRun {
  Result result;
  std::map<std::string, double> seconds;  ///< by step
  size_t verified_cells = 0;
};

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
  std::vector<PathReport> steps_;  ///< by query frame, without matches
  std::vector<std::optional<Cell>> best_;
  ResultPath path_;
};

/// The least margin of the filter, in units of its values.
uint32_t least_margin(const QueryPlan& plan);

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
  const QueryPlan& plan_;
  RecognitionScan recognitions_;
  std::optional<MarginScan> scan_;  ///< nullopt: there are no margins, or the filter reports them
  std::optional<PathRows> paths_;   ///< of the filter
};

/// Distances, recognitions, best matches and clusters of a planned query. Every row also goes to
/// `observers`. Throws Error(expectation) if a verified cell differs, and as match and scored do.
///
/// An approximate query finds recognitions and best matches among the windows that share a hash
/// bucket with a query window, with their exact distances. It has no rows and no margins, and it
/// reports the recall of the search. Throws Error(usage) for descriptors that are not binary.
QueryRun run_query(QueryPlan plan, const QueryResources& resources, const Sinks& observers,
                   const Monitor& monitor);

/// Up to `count` different cells of pairs of windows in runs, uniformly chosen, in the order of
/// CellScan and without scores; fewer if the matrix is smaller. The past is not considered.
std::vector<Cell> choose_cells(const FrameDistances& distances, size_t window_length, size_t count,
                               uint64_t seed);

/// The cells whose distance differs from the reference implementation's, with the correct distance.
std::vector<Cell> wrong_cells(std::span<const Cell> cells, std::span<const DescribedFrames> train,
                              const DescriptorRows& query, size_t window_length,
                              const Monitor& monitor);

/// The cells whose biased sum of z-scores differs from the reference implementation's by more than
/// score_tolerance, with the correct sum, rounded to fixed point. `basis`: of all sequences.
std::vector<Cell> wrong_scores(std::span<const Cell> cells, std::span<const DescribedFrames> train,
                               const DescribedFrames& query, size_t window_length,
                               const ScoreBasis& basis, const Monitor& monitor);

}  // namespace vpr
