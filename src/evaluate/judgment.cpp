#include "evaluate/judgment.h"

#include <algorithm>
#include <cassert>

#include "base/error.h"
#include "evaluate/matrix_scan.h"
#include "evaluate/metrics.h"

namespace vpr {

namespace {

void take_matrix(Judgment& judgment, const ScoreMatrix& matrix, const GroundTruth& truth,
                 const Monitor& monitor) {
  MatrixScan scan = scan_matrix(matrix, truth, judgment.layout, monitor);
  judgment.all_pairs =
      PairJudgment{pair_curve(matrix, truth, judgment.layout, scan, monitor), scan.ignored_pairs,
                   scan.same_without_score, scan.worst_correct};
  judgment.outcomes = std::move(scan.outcomes);
}

size_t column_of(const ScoreLayout& layout, uint32_t sequence, size_t window) {
  const ScoreLayout::Columns* columns = layout.columns_of(sequence);
  return columns == nullptr ? 0 : columns->first + window;
}

size_t count_with_match(const GroundTruth& truth) {
  size_t count = 0;
  for (size_t frame = 0; frame < truth.pairs.size(); ++frame) count += truth.has_match(frame);
  return count;
}

Fix fix_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::correct:
      return Fix::right;
    case Verdict::incorrect:
      return Fix::wrong;
    case Verdict::ignored:
      return Fix::unjudged;
    case Verdict::unreadable:
      return Fix::none;
  }
  return Fix::none;
}

Fix fix_of(PlaceLabel label) {
  return label == PlaceLabel::same        ? Fix::right
         : label == PlaceLabel::different ? Fix::wrong
                                          : Fix::unjudged;
}

}  // namespace

bool is_recognized(const Judgment& judgment, const QueryOutcome& query) {
  return query.verdict != Verdict::unreadable &&
         judgment.fixes[query.frame] == fix_of(query.verdict);
}

void order_by(Judgment& judgment, Confidence confidence) {
  Outcomes& outcomes = judgment.outcomes;
  if (confidence == Confidence::margin && !outcomes.has_margins)
    throw Error(
        ErrorKind::usage,
        "there are no margins: FAB-MAP, lsh and score matrices have none. Omit --confidence");
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
  judgment.layout = layout_of(result);
  judgment.outcomes = outcomes_of(result, truth);
  order_by(judgment, judgment.outcomes.confidence);
  for (const Match& recognition : result.recognitions) {
    check_stop(monitor);
    judgment.recognized.push_back(
        {recognition.query, column_of(judgment.layout, recognition.target, recognition.train)});
  }
  judgment.fixes = fixes_of(result, truth);
  judgment.localization = localize(judgment.fixes, traveled_m);
  judgment.localization.frames_with_match = count_with_match(truth);
  return judgment;
}

Judgment judge(const ScoreMatrix& matrix, const ScoreLayout& layout, const GroundTruth& truth,
               std::optional<double> threshold, std::span<const double> traveled_m,
               const Monitor& monitor) {
  Judgment judgment;
  judgment.layout = layout;
  take_matrix(judgment, matrix, truth, monitor);
  order_by(judgment, Confidence::score);
  judgment.is_oracle = !threshold;
  judgment.threshold =
      threshold ? threshold : recall_at_full_precision(judgment.single_best).threshold;
  std::optional<uint64_t> accepted;
  if (judgment.threshold) accepted = score_key(*judgment.threshold, matrix.kind());
  for (size_t window = 0; window < judgment.outcomes.queries.size(); ++window) {
    const QueryOutcome& query = judgment.outcomes.queries[window];
    if (accepted && query.best && query.key <= *accepted)
      judgment.recognized.push_back(
          {window, column_of(layout, query.best->sequence,
                             query.best->reference + 1 - layout.window_length)});
  }
  judgment.fixes = fixes_of(judgment.outcomes, accepted);
  judgment.localization = localize(judgment.fixes, traveled_m);
  judgment.localization.frames_with_match = count_with_match(truth);
  return judgment;
}

Judgment judge(const Result& result, const ScoreMatrix& matrix, const GroundTruth& truth,
               std::span<const double> traveled_m, const Monitor& monitor) {
  Judgment judgment = judge(result, truth, traveled_m, monitor);
  require_fit(matrix, judgment.layout);
  if (!truth.is_known) return judgment;
  take_matrix(judgment, matrix, truth, monitor);
  add_margins(judgment.outcomes, result);
  order_by(judgment, judgment.outcomes.confidence);
  return judgment;
}

std::vector<const Match*> fixing_recognitions(const Result& result) {
  const ScoreOrder order = result.score().order;
  std::vector<const Match*> recognitions(result.query.frames, nullptr);
  for (const Match& recognition : result.recognitions) {
    const Match*& best = recognitions[anchor_of(recognition.query, result.window_length())];
    if (best == nullptr || is_better(recognition.score, best->score, order)) best = &recognition;
  }
  return recognitions;
}

std::vector<Fix> fixes_of(const Result& result, const GroundTruth& truth) {
  const std::vector<const Match*> recognitions = fixing_recognitions(result);
  std::vector<Fix> fixes(recognitions.size(), Fix::none);
  for (size_t frame = 0; frame < recognitions.size(); ++frame)
    if (recognitions[frame] != nullptr)
      fixes[frame] = fix_of(label_of(truth, *recognitions[frame], result.window_length()));
  return fixes;
}

std::vector<Fix> fixes_of(const Outcomes& outcomes, std::optional<uint64_t> accepted) {
  std::vector<Fix> fixes(outcomes.query_frames, Fix::none);
  if (!accepted) return fixes;
  for (const QueryOutcome& query : outcomes.queries)
    if (query.best && query.key <= *accepted) fixes[query.frame] = fix_of(query.verdict);
  return fixes;
}

}  // namespace vpr
