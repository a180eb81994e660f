#include "evaluate/judgement.h"

#include <algorithm>
#include <cassert>

#include "base/error.h"
#include "evaluate/matrix_scan.h"
#include "evaluate/metrics.h"

namespace vpr {

namespace {

void take_matrix(Judgement& judgement, const ScoreMatrix& matrix, const GroundTruth& truth,
                 const Monitor& monitor) {
  MatrixScan scan = scan_matrix(matrix, truth, judgement.layout, monitor);
  judgement.all_pairs =
      PairJudgement{pair_curve(matrix, truth, judgement.layout, scan, monitor), scan.ignored_pairs,
                    scan.same_without_score, scan.worst_correct};
  judgement.outcomes = std::move(scan.outcomes);
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

bool is_recognised(const Judgement& judgement, const QueryOutcome& query) {
  return query.verdict != Verdict::unreadable &&
         judgement.fixes[query.frame] == fix_of(query.verdict);
}

void order_by(Judgement& judgement, Confidence confidence) {
  Outcomes& outcomes = judgement.outcomes;
  if (confidence == Confidence::margin && !outcomes.has_margins)
    throw Error(
        ErrorKind::usage,
        "there are no margins: FAB-MAP, lsh and score matrices have none. Omit --confidence");
  judgement.other_best.reset();
  if (outcomes.has_margins) {
    outcomes.confidence = confidence == Confidence::score ? Confidence::margin : Confidence::score;
    judgement.other_best = single_best_curve(outcomes);
  }
  outcomes.confidence = confidence;
  judgement.single_best = single_best_curve(outcomes);
}

Judgement judge(const Result& result, const GroundTruth& truth, std::span<const double> travelled_m,
                const Monitor& monitor) {
  Judgement judgement;
  judgement.layout = layout_of(result);
  judgement.outcomes = outcomes_of(result, truth);
  order_by(judgement, judgement.outcomes.confidence);
  for (const Match& hit : result.hits) {
    check_stop(monitor);
    judgement.recognised.push_back({hit.query, column_of(judgement.layout, hit.target, hit.train)});
  }
  judgement.fixes = fixes_of(result, truth);
  judgement.localisation = localise(judgement.fixes, travelled_m);
  judgement.localisation.frames_with_match = count_with_match(truth);
  return judgement;
}

Judgement judge(const ScoreMatrix& matrix, const ScoreLayout& layout, const GroundTruth& truth,
                std::optional<double> threshold, std::span<const double> travelled_m,
                const Monitor& monitor) {
  Judgement judgement;
  judgement.layout = layout;
  take_matrix(judgement, matrix, truth, monitor);
  order_by(judgement, Confidence::score);
  judgement.is_oracle = !threshold;
  judgement.threshold =
      threshold ? threshold : recall_at_full_precision(judgement.single_best).threshold;
  std::optional<uint64_t> accepted;
  if (judgement.threshold) accepted = score_key(*judgement.threshold, matrix.kind());
  for (size_t window = 0; window < judgement.outcomes.queries.size(); ++window) {
    const QueryOutcome& query = judgement.outcomes.queries[window];
    if (accepted && query.best && query.key <= *accepted)
      judgement.recognised.push_back(
          {window, column_of(layout, query.best->sequence,
                             query.best->reference + 1 - layout.window_length)});
  }
  judgement.fixes = fixes_of(judgement.outcomes, accepted);
  judgement.localisation = localise(judgement.fixes, travelled_m);
  judgement.localisation.frames_with_match = count_with_match(truth);
  return judgement;
}

Judgement judge(const Result& result, const ScoreMatrix& matrix, const GroundTruth& truth,
                std::span<const double> travelled_m, const Monitor& monitor) {
  Judgement judgement = judge(result, truth, travelled_m, monitor);
  require_fit(matrix, judgement.layout);
  if (!truth.is_known) return judgement;
  take_matrix(judgement, matrix, truth, monitor);
  add_margins(judgement.outcomes, result);
  order_by(judgement, judgement.outcomes.confidence);
  return judgement;
}

std::vector<const Match*> fixing_hits(const Result& result) {
  const ScoreOrder order = result.score().order;
  std::vector<const Match*> hits(result.query.frames, nullptr);
  for (const Match& hit : result.hits) {
    const Match*& best = hits[anchor_of(hit.query, result.window_length())];
    if (best == nullptr || is_better(hit.score, best->score, order)) best = &hit;
  }
  return hits;
}

std::vector<Fix> fixes_of(const Result& result, const GroundTruth& truth) {
  const std::vector<const Match*> hits = fixing_hits(result);
  std::vector<Fix> fixes(hits.size(), Fix::none);
  for (size_t frame = 0; frame < hits.size(); ++frame)
    if (hits[frame] != nullptr)
      fixes[frame] = fix_of(label_of(truth, *hits[frame], result.window_length()));
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
