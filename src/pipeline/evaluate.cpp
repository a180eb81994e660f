#include "pipeline/evaluate.h"

#include <fmt/format.h>

#include "base/counted.h"
#include "base/error.h"
#include "ground_truth/travelled.h"

namespace vpr {
namespace {

GroundTruth truth_of(const JudgedBy& by, const GroundTruthScope& scope, const Monitor& monitor) {
  return by.ground_truth ? read_ground_truth(*by.ground_truth, scope, monitor)
                         : unknown_ground_truth(scope);
}

std::vector<double> way_of(const JudgedBy& by, const GroundTruthScope& scope,
                           const Monitor& monitor) {
  if (by.poses.empty()) return {};
  return read_travelled(by.poses, scope.query_frames, monitor, scope.replay);
}

void set_replay(GroundTruthScope& scope, const Replay& replay) {
  if (replay.frames() != scope.query_frames)
    throw Error(
        ErrorKind::data,
        fmt::format("the scores are of {} of a query, and of {} the warp {} shows {}; give "
                    "the warp, its seed and the number of frames that they were made with",
                    counted(scope.query_frames, "frame"), counted(replay.recorded_frames, "frame"),
                    replay.warp, replay.frames()));
  scope.replay = replay;
}

}  // namespace

Evaluation evaluate_result(Result result, std::optional<ScoreMatrix> matrix, const JudgedBy& by,
                           const Monitor& monitor) {
  Evaluation evaluation;
  evaluation.query_name = result.query_name;
  const GroundTruthScope scope = scope_of(result);
  evaluation.truth = truth_of(by, scope, monitor);
  const GroundTruth& truth = evaluation.truth;
  const std::vector<double> travelled_m = way_of(by, scope, monitor);
  evaluation.judgement = matrix ? judge(result, *matrix, truth, travelled_m, monitor)
                                : judge(result, truth, travelled_m, monitor);
  order_by(evaluation.judgement, by.confidence);
  if (!by.recall_at.empty()) evaluation.judgement.recall_at = by.recall_at;
  evaluation.judgement.stretch_frames = by.stretch_frames;
  JudgedResult& judged = evaluation.result.emplace();
  judged.counts = count_recognitions(result, truth, monitor);
  judged.by_view = count_by_view(result, truth, monitor);
  judged.clusters = judge_clusters(result, clusters_of(result), truth, monitor);
  judged.result = std::move(result);
  evaluation.matrix = std::move(matrix);
  return evaluation;
}

Evaluation evaluate_scores(ScoreMatrix matrix, const ScoreSettings& settings,
                           const std::string& query_name, const JudgedBy& by,
                           const Monitor& monitor) {
  Evaluation evaluation;
  evaluation.query_name = query_name;
  evaluation.scores = settings;
  ScoreLayout layout = layout_of(matrix, settings.window_length);
  if (settings.replay) set_replay(layout.scope, *settings.replay);
  evaluation.truth = truth_of(by, layout.scope, monitor);
  const std::vector<double> travelled_m = way_of(by, layout.scope, monitor);
  evaluation.judgement =
      judge(matrix, layout, evaluation.truth, settings.threshold, travelled_m, monitor);
  order_by(evaluation.judgement, by.confidence);
  if (!by.recall_at.empty()) evaluation.judgement.recall_at = by.recall_at;
  evaluation.judgement.stretch_frames = by.stretch_frames;
  evaluation.fingerprint = matrix.fingerprint(monitor);
  evaluation.matrix = std::move(matrix);
  return evaluation;
}

}  // namespace vpr
