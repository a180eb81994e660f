// Evaluation in one call: how right a result is, or the scores of any method.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "evaluate/counts.h"
#include "evaluate/judgment.h"
#include "truth/ground_truth.h"

namespace vpr {

/// What a query is judged by.
struct JudgedBy {
  std::optional<GroundTruthArgument> ground_truth;  ///< none: what is found counts as unjudged
  std::filesystem::path poses;  ///< of the query's frames, for meters; empty: frames only
  std::optional<Confidence> confidence = {};  ///< of best matches; none: what the result decided by
  std::vector<size_t> recall_at = {};         ///< K of recall@K; none: kRecallAt
  size_t stretch_frames = kRouteStretch;      ///< of the recall achievement rate
  NameReader query_names = {};                ///< for a ground truth that names frames
  std::vector<NameReader> train_names = {};   ///< the same, by training sequence
};

/// What is known of a score matrix of another program.
struct ScoreSettings {
  std::string method = "scores";  ///< a name for tables
  ScoreFormat format;
  uint64_t window_length = 1;       ///< rows and columns are windows of so many frames
  std::optional<double> threshold;  ///< of a fix; none: that of recall at 100 % precision
  Sequence query = {};              ///< its name, and the selection that its rows are of
};

/// A result as a ground truth sees it.
struct JudgedResult {
  Result result;
  Counts counts;
  std::optional<CountsByView> by_view;  ///< none where the result does not say where views begin
  std::vector<JudgedCluster> clusters;  ///< one for each of clusters_of(result)
};

struct Evaluation {
  std::optional<std::string> name;  ///< that the user gave to the result or the scores
  GroundTruth truth;                ///< whose labels are not known where there is none
  Judgment judgment;
  std::optional<JudgedResult> result;  ///< none: scores alone
  ScoreSettings scores;                ///< of scores alone
  std::optional<ScoreMatrix> matrix;   ///< of scores, or the one that was saved with the result
  std::string fingerprint;             ///< of the file of the result, or of the scores

  const Sequence& query() const { return judgment.layout.scope.query; }
};

/// A result, with the matrix that was saved with it, if there is one. Throws what
/// read_ground_truth, read_traveled, judge and order_by throw.
Evaluation evaluate_result(Result result, std::optional<ScoreMatrix> matrix, const JudgedBy& by,
                           const Monitor& monitor);

/// Scores alone, of any program. `by` names a ground truth. Throws as evaluate_result does, and
/// Error(data) for a selection of another number of frames.
Evaluation evaluate_scores(ScoreMatrix matrix, const ScoreSettings& settings, const JudgedBy& by,
                           const Monitor& monitor);

}  // namespace vpr
