#include "evaluate/judgment.h"

#include "base/error.h"

namespace vpr {
namespace {

void set_pairs(Judgment& judgment, MatrixScan scan) {
  judgment.outcomes = std::move(scan.outcomes);
  judgment.all_pairs = std::move(scan.pairs);
}

std::span<const std::optional<uint32_t>> decided_frames(const Result& result) {
  if (!result.path) return {};
  return result.path->decided;
}

void set_verdicts(Judgment& judgment, std::vector<Verdict> verdicts,
                  std::span<const double> traveled_m,
                  std::span<const std::optional<uint32_t>> decided = {}) {
  Localization& path = judgment.localization = localize(verdicts, traveled_m, decided);
  judgment.verdicts = std::move(verdicts);
  for (const QueryOutcome& query : judgment.outcomes.queries) {
    path.frames_with_match += query.has_match;
    path.off_map += !query.has_match && judgment.verdicts[query.frame] == Verdict::incorrect;
  }
}

}  // namespace

bool is_recognized(const Judgment& judgment, const QueryOutcome& query) {
  return query.verdict != Verdict::none && judgment.verdicts[query.frame] == query.verdict;
}

void set_confidence(Judgment& judgment, Confidence confidence) {
  Outcomes& outcomes = judgment.outcomes;
  if (confidence == Confidence::margin && !outcomes.has_margins)
    throw Error(ErrorKind::usage,
                "FAB-MAP, lsh and score matrices have no margins. Omit --confidence");
  judgment.other_best.reset();
  if (outcomes.has_margins) {
    outcomes.confidence = confidence == Confidence::score ? Confidence::margin : Confidence::score;
    judgment.other_best = single_best_curve(outcomes);
  }
  outcomes.confidence = confidence;
  judgment.single_best = single_best_curve(outcomes);
}

Judgment judge(const Result& result, const GroundTruth& truth, std::span<const double> traveled_m,
               const Monitor& monitor) {
  Judgment judgment;
  if (!truth.is_known) judgment.by = JudgedBy::nothing;
  judgment.layout = layout_of(result);
  judgment.outcomes = outcomes_of(result, truth);
  set_confidence(judgment, judgment.outcomes.confidence);
  for (const Match& recognition : result.recognitions) {
    check_stop(monitor);
    judgment.recognized.push_back(anchors_of(recognition, result.window_length()));
  }
  set_verdicts(judgment, verdicts_of(result, truth), traveled_m, decided_frames(result));
  return judgment;
}

void judge_by_places(Judgment& judgment, const Result& result, std::span<const PlaceLabel> labels,
                     std::span<const double> traveled_m) {
  judgment.by = JudgedBy::places;
  const std::vector<const Match*> recognitions = recognitions_by_frame(result);
  for (size_t frame = 0; frame < recognitions.size(); ++frame)
    if (const Match* recognition = recognitions[frame])
      judgment.verdicts[frame] =
          verdict_of(labels[static_cast<size_t>(recognition - result.recognitions.data())]);
  for (size_t window = 0; window < result.best.size(); ++window) {
    QueryOutcome& query = judgment.outcomes.at_window(window);
    const Match* recognition = recognitions[query.frame];
    if (recognition != nullptr && result.best[window] == *recognition)
      query.verdict = judgment.verdicts[query.frame];
  }
  // Which other frames have a match is unknown: all frames count.
  for (QueryOutcome& query : judgment.outcomes.queries) query.has_match = true;
  set_verdicts(judgment, judgment.verdicts, traveled_m, decided_frames(result));
}

Judgment judge(const ScoreMatrix& matrix, const ScoreLayout& layout, const GroundTruth& truth,
               std::optional<double> threshold, std::span<const double> traveled_m,
               const Monitor& monitor) {
  Judgment judgment;
  judgment.layout = layout;
  set_pairs(judgment, scan_matrix(matrix, truth, judgment.layout, monitor));
  set_confidence(judgment, Confidence::score);
  judgment.is_oracle = !threshold && matrix.has_scores;
  judgment.threshold =
      threshold ? threshold : recall_at_full_precision(judgment.single_best).threshold;
  std::optional<uint64_t> accepted;
  if (judgment.threshold) accepted = score_key(*judgment.threshold, matrix.kind);
  if (!matrix.has_scores) accepted = kNoScore - 1;  // the first of each list
  for (const QueryOutcome& query : judgment.outcomes.queries)
    if (accepted && query.best && query.key <= *accepted)
      judgment.recognized.push_back({query.frame, *query.best});
  set_verdicts(judgment, verdicts_of(judgment.outcomes, accepted), traveled_m);
  return judgment;
}

Judgment judge(const Result& result, const ScoreMatrix& matrix, const GroundTruth& truth,
               std::span<const double> traveled_m, const Monitor& monitor) {
  Judgment judgment = judge(result, truth, traveled_m, monitor);
  require_fit(matrix, judgment.layout);
  if (!truth.is_known) return judgment;
  MatrixScan scan = scan_matrix(matrix, truth, judgment.layout, monitor, false);
  for (const QueryOutcome& query : scan.outcomes.queries)
    if (query.best != judgment.outcomes.queries[query.frame].best)
      throw Error(ErrorKind::data,
                  "the matrix has another best match for query frame {} than the result. Use the "
                  "matrix that was saved with it, or vpr-eval matrix SCORES",
                  query.frame);
  set_pairs(judgment, std::move(scan));
  add_margins(judgment.outcomes, result);
  set_confidence(judgment, judgment.outcomes.confidence);
  return judgment;
}

std::vector<const Match*> recognitions_by_frame(const Result& result) {
  const ScoreOrder order = result.score().order;
  std::vector<const Match*> recognitions(result.query.frames, nullptr);
  for (const Match& recognition : result.recognitions) {
    const Match*& best = recognitions[anchor_of(recognition.query, result.window_length())];
    if (best == nullptr || is_better(recognition.score, best->score, order)) best = &recognition;
  }
  return recognitions;
}

std::vector<Verdict> verdicts_of(const Result& result, const GroundTruth& truth) {
  const std::vector<const Match*> recognitions = recognitions_by_frame(result);
  std::vector<Verdict> verdicts(recognitions.size(), Verdict::none);
  for (size_t frame = 0; frame < recognitions.size(); ++frame)
    if (recognitions[frame] != nullptr)
      verdicts[frame] = verdict_of(label_of(truth, *recognitions[frame], result.window_length()));
  return verdicts;
}

std::vector<Verdict> verdicts_of(const Outcomes& outcomes, std::optional<uint64_t> accepted) {
  std::vector<Verdict> verdicts(outcomes.queries.size(), Verdict::none);
  if (!accepted) return verdicts;
  for (const QueryOutcome& query : outcomes.queries)
    if (query.best && query.key <= *accepted) verdicts[query.frame] = query.verdict;
  return verdicts;
}

}  // namespace vpr
