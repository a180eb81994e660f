// Evaluation of a result, or of the scores of any method, by ground truth or by the answers of a
// person who saw images of each place: the same place, or not.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "evaluate/intervals.h"
#include "evaluate/judgment.h"
#include "evaluate/outcomes.h"
#include "query/result_file.h"
#include "truth/ground_truth.h"

namespace vpr {

struct EvaluationSettings {
  std::optional<GroundTruthArgument> ground_truth;  ///< nullopt: no pair is judged
  std::string poses;  ///< of the query's frames, for meters; empty: frames only
  std::optional<Confidence> confidence = {};  ///< of best matches; nullopt: as the result decided
  std::vector<size_t> recall_at = {};         ///< K of recall@K, besides 1; empty: kRecallAt
  size_t stretch_frames = kDefaultStretch;    ///< for the recall achievement rate
  NameReader query_names = {};                ///< for a ground truth with names of frames
  std::vector<NameReader> train_names = {};   ///< likewise, by training sequence
  std::string places = {};                    ///< answers to the places of a result; empty: none
  std::string warned_as = {};                 ///< the matches in warnings; empty: the only ones
};

template <class Visitor>
void visit_fields(EvaluationSettings& by, Visitor&& visit) {
  visit("confidence", by.confidence);
  visit("recall_at", by.recall_at);
  visit("stretch", by.stretch_frames);
  visit("places", by.places);
  visit("poses", by.poses);
}

/// The meaning of a score matrix of any program.
struct ScoreSettings {
  std::string method = "scores";  ///< a name for tables
  ScoreFormat format;
  uint64_t window_length = 1;       ///< frames of the windows of rows and columns
  std::optional<double> threshold;  ///< of a fix; nullopt: at the recall at 100 % precision
  Sequence query = {};              ///< name and selection
};

/// The answers of a person to the places of a result.
struct PlaceAnswers {
  std::vector<PlaceLabel> of_recognition;  ///< of the part of its place; ignore: no answer
  size_t answers = 0;
  size_t most_frames = 0;  ///< query frames that one answer judges
};

struct EvaluatedResult {
  std::shared_ptr<const Result> result;  ///< never null
  Counts counts;
  std::optional<CountsByKeyframe> by_keyframe;  ///< nullopt without keyframes or ground truth
  std::vector<JudgedCluster> clusters;          ///< by index of clusters_of(result)
  std::optional<PlaceAnswers> answers = {};
};

struct Evaluation {
  std::optional<std::string> name;           ///< of the result or the scores, set by the user
  std::optional<std::string> data_set = {};  ///< likewise, in tables of several
  GroundTruth truth;                         ///< labels are unknown without a ground truth
  Judgment judgment;
  std::optional<EvaluatedResult> result;  ///< nullopt: scores alone
  ScoreSettings scores;                   ///< of scores alone
  std::optional<ScoreMatrix> matrix;      ///< the scores, or the matrix saved with the result
  std::string fingerprint;                ///< of the file of the result or of the scores
  bool warned_of_ground_truth = false;    ///< a warning named another tolerance or --train-step
  std::string caution = {};               ///< about labels that are not a sample, or of this result

  const Sequence& query() const { return judgment.layout.scope.query; }
};

/// Throws Error(usage) for settings out of range.
void check_evaluation(const EvaluationSettings& by);

/// Throws Error(usage) for labels of single pairs, which cannot choose settings: other pairs are
/// unknown, and a looser threshold would seem to make no mistake.
void require_all_pairs(const GroundTruth& truth, const EvaluationSettings& by);

/// The ground truth of an evaluation that chooses settings, for the indices of `scope`, whose names
/// are those of `by`. Throws what read_ground_truth and require_all_pairs throw.
GroundTruth whole_truth_of(const EvaluationSettings& by, GroundTruthScope scope,
                           const Monitor& monitor);

/// Evaluates a result, with the matrix that was saved with it, if there is one. Throws what
/// read_ground_truth, read_place_answers, read_traveled, judge and set_confidence throw.
Evaluation evaluate_result(std::shared_ptr<const Result> result, std::optional<ScoreMatrix> matrix,
                           const EvaluationSettings& by, const Monitor& monitor);

/// Evaluates a result. Names of frames that `by` lacks are those of the query and the
/// database of the run, unless the result has places. Throws as evaluate_result does.
Evaluation evaluate_stored(const std::shared_ptr<const StoredResult>& stored,
                           std::optional<ScoreMatrix> matrix, EvaluationSettings by,
                           const Monitor& monitor);

/// Evaluates scores of any program. `by` has a ground truth. Throws as evaluate_result does, and
/// Error(data) for a selection with another number of frames.
Evaluation evaluate_scores(ScoreMatrix matrix, const ScoreSettings& settings,
                           const EvaluationSettings& by, const Monitor& monitor);

/// The label that a person gave to the best match of a query frame; unset: none.
std::optional<PlaceLabel> answer_to(const Evaluation& evaluation, const QueryOutcome& query);

/// The share of correct best matches by labels of a sample of the query's frames; unset without a
/// sample, and if a best match of its frames is not labeled.
std::optional<Estimate> estimated_recall(const Evaluation& evaluation);

/// The best matches that are more confident than the first incorrect one among all labels.
struct LabeledThreshold {
  size_t labels = 0;                ///< of best matches
  std::optional<double> threshold;  ///< score or margin of the first incorrect one; unset: none
  size_t accepted = 0;              ///< frames of the query with a more confident best match
};
/// Unset without labels of a sample.
std::optional<LabeledThreshold> labeled_threshold(const Evaluation& evaluation);

/// The recognized query frames with the match by which each is judged.
std::vector<MatchedFrame> recognized_frames(const Evaluation& evaluation);

/// Warns if queries have no score, if the opposite order of the scores is correct for more queries,
/// and if the best score may be the missing value of vpr-query. `source`: of the scores, for
/// messages.
void warn_of_scores(const Judgment& judgment, const ScoreInput& scores, const std::string& source,
                    const Monitor& monitor);

}  // namespace vpr
