// The judgment of a result or a score matrix, from which reports and plots are made.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "evaluate/metrics.h"

namespace vpr {

/// Per query frame, the recognition of the window that ends there: of several the one with the best
/// score, ties to the first; null if there is none. They point into the result.
std::vector<const Match*> recognitions_by_frame(const Result& result);
/// The verdicts by these recognitions.
std::vector<Verdict> verdicts_of(const Result& result, const GroundTruth& truth);
/// The verdicts by best matches whose key is at most `accepted`; unset: none.
std::vector<Verdict> verdicts_of(const Outcomes& outcomes, std::optional<uint64_t> accepted);

/// All pairs of frames, except pairs labeled ignore.
struct PairJudgment {
  Curve curve;                      ///< recall is over all pairs of the same place
  uint64_t ignored = 0;             ///< pairs labeled ignore
  uint64_t same_without_score = 0;  ///< of curve.positives: never found
  uint64_t worst_correct = 0;       ///< queries whose worst score, ties to the first, is correct
};

struct MatrixScan {
  Outcomes outcomes;
  PairJudgment pairs;
};

/// References labeled ignore are skipped for best matches and ranks, unless they may be answers of
/// a result (`skips_ignored`); ties go to the first column. Reads the matrix twice: memory is 8
/// bytes per pair of the same place, and about 60 per distinct score among them, since all other
/// pairs are only counted between these. Throws as ScoreMatrix::for_each_row does.
MatrixScan scan_matrix(const ScoreMatrix& matrix, const GroundTruth& truth,
                       const ScoreLayout& layout, const Monitor& monitor,
                       bool skips_ignored = true);

/// The answers of all query frames, judged.
struct JudgedFrames {
  JudgedBy by = JudgedBy::ground_truth;
  Outcomes outcomes;
  std::vector<Verdict> verdicts;  ///< one per query frame
  Localization localization;
  bool is_oracle = false;  ///< the threshold of verdicts was chosen from the ground truth
};

struct Judgment : JudgedFrames {
  ScoreLayout layout;
  Curve single_best;
  std::optional<Curve> other_best;        ///< by the other confidence, if margins are known
  std::optional<PairJudgment> all_pairs;  ///< of a matrix
  std::vector<MatchedFrame> recognized;   ///< by a result; without one, accepted best matches
  std::optional<double> threshold;        ///< of accepted best matches
  std::vector<size_t> recall_at{kRecallAt.begin(), kRecallAt.end()};  ///< K to report
  size_t stretch_frames = kDefaultStretch;  ///< of the reported recall achievement rate
};

/// Whether the verdict of the frame equals the verdict of its best match. With one threshold per
/// sequence, the recognition may differ from the best match.
bool is_recognized(const Judgment& judgment, const QueryOutcome& query);

/// Accepts best matches by this confidence. Throws Error(usage) for margin if there are no margins.
void set_confidence(Judgment& judgment, Confidence confidence);

/// `traveled_m`: as in localize.
Judgment judge(const Result& result, const GroundTruth& truth, std::span<const double> traveled_m,
               const Monitor& monitor = {});

/// Replaces the verdicts of recognized frames, and of best matches that are their recognitions, by
/// `labels` of the result's recognitions. All frames then count as frames with a match.
/// `traveled_m`: as in localize.
void judge_by_places(Judgment& judgment, const Result& result, std::span<const PlaceLabel> labels,
                     std::span<const double> traveled_m);

/// Accepts best matches whose score is `threshold` or better; by default, the threshold of recall
/// at 100 % precision.
Judgment judge(const ScoreMatrix& matrix, const ScoreLayout& layout, const GroundTruth& truth,
               std::optional<double> threshold, std::span<const double> traveled_m,
               const Monitor& monitor);

/// As for the result, with the ranks and pairs of the matrix that was saved with it; without them
/// if the ground truth is unknown. Throws Error(data) if the sizes or the best matches of the two
/// differ.
Judgment judge(const Result& result, const ScoreMatrix& matrix, const GroundTruth& truth,
               std::span<const double> traveled_m, const Monitor& monitor);

}  // namespace vpr
