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

bool is_judged(const QueryOutcome& query) {
  return query.verdict == Verdict::correct || query.verdict == Verdict::incorrect;
}

template <class Value>
std::optional<double> mean_of_judged(const Outcomes& outcomes, size_t k, const Value& value) {
  if (!outcomes.has_ranks || k > kMostRanked) return std::nullopt;
  double sum = 0;
  size_t judged = 0;
  for (const QueryOutcome& query : outcomes.queries) {
    if (!query.has_match || !is_judged(query)) continue;
    ++judged;
    sum += value(query);
  }
  if (judged == 0) return std::nullopt;
  return sum / static_cast<double>(judged);
}

}  // namespace

void look_up_match(QueryOutcome& query, const GroundTruth& truth, const ScoreLayout& layout) {
  query.has_match = has_column_of(truth, layout, query.frame);
  query.is_unreachable = !query.has_match && truth.has_match(query.frame);
}

Outcomes outcomes_of(const Result& result, const GroundTruth& truth) {
  const ScoreLayout layout = layout_of(result);
  const size_t length = result.window_length();
  Outcomes outcomes{result.score().order, result.query_frames, length, false, {}};
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

std::optional<double> recall_at(const Outcomes& outcomes, size_t k) {
  const uint64_t judged = judged_queries(outcomes);
  if (judged == 0 || (k > 1 && !outcomes.has_ranks)) return std::nullopt;
  const auto found =
      std::count_if(outcomes.queries.begin(), outcomes.queries.end(),
                    [&](const QueryOutcome& query) { return is_found_at(query, k); });
  return static_cast<double>(found) / static_cast<double>(judged);
}

std::optional<double> precision_at(const Outcomes& outcomes, size_t k) {
  return mean_of_judged(outcomes, k, [&](const QueryOutcome& query) {
    const auto right = std::ranges::count_if(query.right_ranks, [&](auto r) { return r <= k; });
    return static_cast<double>(right) / static_cast<double>(k);
  });
}

std::optional<double> mean_average_precision_at(const Outcomes& outcomes, size_t k) {
  return mean_of_judged(outcomes, k, [&](const QueryOutcome& query) {
    double sum = 0;
    size_t right = 0;
    for (const uint8_t rank : query.right_ranks)
      if (rank <= k) sum += static_cast<double>(++right) / static_cast<double>(rank);
    return sum / static_cast<double>(std::min<size_t>(k, std::max<size_t>(1, query.right_count)));
  });
}

std::vector<std::optional<double>> local_recalls(const Outcomes& outcomes, size_t stretch_frames) {
  const size_t frames = outcomes.query_frames;
  const size_t count = std::max<size_t>(1, (frames + stretch_frames / 2) / stretch_frames);
  std::vector<size_t> found(count);
  std::vector<size_t> judged(count);
  for (const QueryOutcome& query : outcomes.queries) {
    if (!query.has_match || !is_judged(query)) continue;
    // The stretch s holds frames from floor(s * frames / count) on.
    const size_t stretch = ((query.frame + 1) * count - 1) / frames;
    ++judged[stretch];
    if (is_found_at(query, 1)) ++found[stretch];
  }
  std::vector<std::optional<double>> recalls(count);
  for (size_t s = 0; s < count; ++s)
    if (judged[s] > 0) recalls[s] = static_cast<double>(found[s]) / static_cast<double>(judged[s]);
  return recalls;
}

std::optional<double> recall_achievement(const std::vector<std::optional<double>>& recalls,
                                         double target) {
  size_t known = 0;
  size_t achieved = 0;
  for (const auto& recall : recalls) {
    if (!recall) continue;
    ++known;
    achieved += *recall >= target;
  }
  if (known == 0) return std::nullopt;
  return static_cast<double>(achieved) / static_cast<double>(known);
}

}  // namespace vpr
