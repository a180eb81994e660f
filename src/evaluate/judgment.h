// Everything that is known about how right a method is: what reports and pictures are made of.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "evaluate/matrix_scan.h"
#include "evaluate/metrics.h"

namespace vpr {

/// The recognition that fixes each query frame, or none: of the window that ends there, of several
/// the one with the best score, ties to the first. They live as long as the result.
std::vector<const Match*> fixing_recognitions(const Result& result);
/// One fix a frame: the recognition of the window that ends there; of several the one with the best
/// score, ties to the first.
std::vector<Fix> fixes_of(const Result& result, const GroundTruth& truth);
/// Best matches whose key is at most `accepted`; none: no fix.
std::vector<Fix> fixes_of(const Outcomes& outcomes, std::optional<uint64_t> accepted);

/// All pairs of a score matrix.
struct PairJudgment {
  Curve curve;
  uint64_t ignored = 0;             ///< pairs left out
  uint64_t same_without_score = 0;  ///< to find, but never found
  uint64_t worst_correct = 0;       ///< queries whose worst score is right
};

/// A recognized cell: query window and column of the layout.
struct RecognizedCell {
  size_t query_window = 0;
  size_t column = 0;
};

/// All that ground truth says about a result or a score matrix.
struct Judgment {
  ScoreLayout layout;
  Outcomes outcomes;
  Curve single_best;
  std::optional<Curve> other_best;  ///< the same by the other confidence, where margins are known
  std::optional<PairJudgment> all_pairs;  ///< where there is a matrix
  std::vector<RecognizedCell>
      recognized;                   ///< recognitions of a result, accepted best matches of scores
  std::optional<double> threshold;  ///< of accepted best matches
  bool is_oracle = false;           ///< the threshold was chosen from the ground truth
  std::vector<Fix> fixes;           ///< one a query frame
  Localization localization;
  std::vector<size_t> recall_at{kRecallAt.begin(), kRecallAt.end()};  ///< K of what is reported
  size_t stretch_frames = kRouteStretch;  ///< of what is reported of the recall achievement rate
};

/// Whether the frame's fix is as right as the query's best match, so that the one can stand for the
/// other in pictures: with a threshold for each sequence, the recognition may be another than the
/// best match.
bool is_recognized(const Judgment& judgment, const QueryOutcome& query);

/// Orders best matches by this confidence from now on. Throws Error(usage) where it is margin, and
/// no margins are known.
void order_by(Judgment& judgment, Confidence confidence);

/// `traveled_m` is what localize takes: one value a query frame, or none.
Judgment judge(const Result& result, const GroundTruth& truth, std::span<const double> traveled_m,
               const Monitor& monitor = {});

/// A matrix of any program. Best matches that score at least as good as `threshold` are accepted;
/// without one, the threshold is that of recall at 100 % precision.
Judgment judge(const ScoreMatrix& matrix, const ScoreLayout& layout, const GroundTruth& truth,
               std::optional<double> threshold, std::span<const double> traveled_m,
               const Monitor& monitor);

/// A result with the matrix that was saved with it: outcomes and curves are the matrix's, and what
/// is recognized is the result's; where the ground truth is not known, outcomes are the result's,
/// too. Throws Error(data) if the two do not fit.
Judgment judge(const Result& result, const ScoreMatrix& matrix, const GroundTruth& truth,
               std::span<const double> traveled_m, const Monitor& monitor);

}  // namespace vpr
