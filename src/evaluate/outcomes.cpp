#include "evaluate/outcomes.h"

#include <algorithm>

namespace vpr {

namespace {

Verdict verdict_of(PlaceLabel label) {
  switch (label) {
    case PlaceLabel::same:
      return Verdict::correct;
    case PlaceLabel::different:
      return Verdict::incorrect;
    case PlaceLabel::ignore:
      return Verdict::ignored;
  }
  return Verdict::incorrect;
}

}  // namespace

void sort_items(std::vector<ScoredItem>& items) {
  std::sort(items.begin(), items.end(),
            [](const ScoredItem& a, const ScoredItem& b) { return a.key < b.key; });
}

Curve curve_of(std::span<const ScoredItem> items, uint64_t to_find, ScoreOrder kind) {
  Curve curve{kind, to_find, {}};
  CurvePoint last;  // what has been accepted so far
  bool is_kept = true;
  for (size_t i = 0; i < items.size() && items[i].key != kNoScore;) {
    CurvePoint point{items[i].key, last.correct, last.incorrect, last.incorrect};
    for (; i < items.size() && items[i].key == point.key; ++i)
      (items[i].is_correct ? point.correct : point.incorrect) += items[i].weight;
    if (point.correct == last.correct && point.incorrect == last.incorrect) continue;
    is_kept = curve.points.empty() || point.correct > last.correct;
    if (is_kept) curve.points.push_back(point);
    last = point;
  }
  if (!is_kept) curve.points.push_back(last);
  return curve;
}

bool is_judged(const QueryOutcome& query) {
  return query.verdict == Verdict::correct || query.verdict == Verdict::incorrect;
}

void look_up_match(QueryOutcome& query, const GroundTruth& truth, const ScoreLayout& layout) {
  query.has_match = has_column_of(truth, layout, query.frame);
  query.is_unreachable = !query.has_match && truth.has_match(query.frame);
}

Outcomes outcomes_of(const Result& result, const GroundTruth& truth) {
  const ScoreLayout layout = layout_of(result);
  const size_t length = result.window_length();
  Outcomes outcomes{result.score().order, result.query.frames, length, false, {}};
  for (size_t window = 0; window < result.best.size(); ++window) {
    QueryOutcome& query = outcomes.queries.emplace_back();
    query.frame = anchor_of(window, length);
    look_up_match(query, truth, layout);
    const auto& best = result.best[window];
    if (best) {
      query.best = FrameMatch{best->target, anchor_of(best->train, length)};
      query.key = score_key(best->score, outcomes.kind);
      query.verdict = verdict_of(label_of(truth, *best, length));
    } else if (shows_unreadable(result, window)) {
      query.verdict = Verdict::unreadable;
    }
  }
  add_margins(outcomes, result);
  return outcomes;
}

void add_margins(Outcomes& outcomes, const Result& result) {
  outcomes.has_margins = !result.margins.empty();
  const auto* settings = std::get_if<SequenceQuerySettings>(&result.settings);
  if (outcomes.has_margins && settings != nullptr && settings->decision == Decision::margin)
    outcomes.confidence = Confidence::margin;
  for (size_t window = 0; window < result.margins.size(); ++window) {
    QueryOutcome& query = outcomes.queries[window];
    const auto& best = result.best[window];
    if (best && query.best && query.best->sequence == best->target &&
        query.best->reference == anchor_of(best->train, result.window_length())) {
      query.margin = frame_margin(result, window);
      query.asked_margin = result.targets[best->target].margin;
    }
  }
}

uint64_t confidence_key(const QueryOutcome& query, Confidence by) {
  if (by == Confidence::score) return query.key;
  return query.margin ? score_key(*query.margin, ScoreOrder::similarity) : kNoScore;
}

ScoreOrder confidence_order(const Outcomes& outcomes) {
  return outcomes.confidence == Confidence::score ? outcomes.kind : ScoreOrder::similarity;
}

uint64_t judged_queries(const Outcomes& outcomes) {
  return static_cast<uint64_t>(std::ranges::count_if(
      outcomes.queries, [](const QueryOutcome& q) { return q.has_match && is_judged(q); }));
}

uint64_t tied_queries(const Outcomes& outcomes) {
  return static_cast<uint64_t>(std::ranges::count(outcomes.queries, true, &QueryOutcome::is_tied));
}

BestMatchCounts best_match_counts(const Outcomes& outcomes) {
  BestMatchCounts counts;
  for (const QueryOutcome& query : outcomes.queries) {
    if (query.verdict == Verdict::unreadable) {
      ++counts.unreadable;
    } else if (query.is_unreachable) {
      ++counts.unreachable;
    } else if (!query.has_match) {
      ++counts.without_match;
    } else {
      ++counts.queries;
      if (query.verdict == Verdict::correct) ++counts.correct;
      if (query.verdict == Verdict::ignored) ++counts.ignored;
    }
  }
  return counts;
}

Curve single_best_curve(const Outcomes& outcomes) {
  std::vector<ScoredItem> items;
  for (const QueryOutcome& query : outcomes.queries)
    if (is_judged(query))
      items.push_back(
          {confidence_key(query, outcomes.confidence), query.verdict == Verdict::correct});
  sort_items(items);
  return curve_of(items, judged_queries(outcomes), confidence_order(outcomes));
}

bool is_found_at(const QueryOutcome& query, size_t k) {
  if (!query.has_match) return false;
  return query.verdict == Verdict::correct ||
         (query.verdict == Verdict::incorrect && query.rank && *query.rank <= k);
}

}  // namespace vpr
