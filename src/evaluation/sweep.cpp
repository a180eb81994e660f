#include "evaluation/sweep.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <fmt/format.h>

namespace vpr {
namespace {

// Larger is better.
auto rank(const SweepScore& score) {
  return std::tuple(score.distinct, score.hits, -static_cast<int64_t>(score.window));
}

bool beats(const SweepScore& a, const SweepScore& b) {
  return a.distinct >= b.distinct && a.incorrect <= b.incorrect &&
         (a.distinct > b.distinct || a.incorrect < b.incorrect);
}

std::vector<size_t> pareto_front(std::span<const SweepScore> scores) {
  std::vector<size_t> front;
  for (size_t i = 0; i < scores.size(); ++i)
    if (std::none_of(scores.begin(), scores.end(),
                     [&](const SweepScore& other) { return beats(other, scores[i]); }))
      front.push_back(i);
  return front;
}

std::optional<size_t> find_nearest_error(std::span<const SweepScore> scores, size_t chosen) {
  std::optional<size_t> nearest;
  if (!scores[chosen].threshold) return nearest;
  const auto distance = [&](size_t i) {
    return std::abs(*scores[i].threshold - *scores[chosen].threshold);
  };
  for (size_t i = 0; i < scores.size(); ++i)
    if (scores[i].threshold && scores[i].incorrect > 0 &&
        scores[i].window == scores[chosen].window && (!nearest || distance(i) < distance(*nearest)))
      nearest = i;
  return nearest;
}

}  // namespace

SweepScore score_of(const SequenceCellCounts& cell) {
  return {cell.counts.distinct, cell.counts.places.incorrect, cell.counts.hits.correct,
          cell.window_length, cell.distance_threshold};
}

SweepScore score_of(const FabmapCellCounts& cell) {
  return {cell.counts.distinct, cell.counts.hits.incorrect, cell.counts.hits.correct, cell.window,
          cell.place_threshold};
}

Recommendation recommend(std::span<const SweepScore> scores) {
  Recommendation choice;
  choice.pareto = pareto_front(scores);
  for (size_t i = 0; i < scores.size(); ++i) {
    if (scores[i].incorrect > 0 || scores[i].distinct == 0) continue;
    if (!choice.cell || rank(scores[i]) > rank(scores[*choice.cell])) choice.cell = i;
  }
  if (!choice.cell) {
    const bool any = std::any_of(scores.begin(), scores.end(),
                                 [](const SweepScore& score) { return score.distinct > 0; });
    choice.reason = any ? "every setting that recognises a place has an incorrect one, too"
                        : "no setting recognises a place";
    return choice;
  }
  const SweepScore& best = scores[*choice.cell];
  choice.nearest_error = find_nearest_error(scores, *choice.cell);
  choice.reason = fmt::format(
      "most distinct correct places ({}) without an incorrect one; of equals the one "
      "with most correct hits ({}), then the shortest window",
      best.distinct, best.hits);
  return choice;
}

}  // namespace vpr
