#include "evaluation/sweep.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace vpr {
namespace {

/// Indices of the cells of one window whose thresholds are numbers, the strictest first.
using Ladder = std::vector<size_t>;

std::map<uint64_t, Ladder> ladders_of(std::span<const SweepScore> scores) {
  std::map<uint64_t, Ladder> ladders;
  for (size_t i = 0; i < scores.size(); ++i)
    if (scores[i].looseness) ladders[scores[i].window].push_back(i);
  for (auto& entry : ladders)
    std::stable_sort(entry.second.begin(), entry.second.end(), [&](size_t a, size_t b) {
      return *scores[a].looseness < *scores[b].looseness;
    });
  return ladders;
}

Ladder::const_iterator find_first_error(const Ladder& ladder, std::span<const SweepScore> scores) {
  return std::find_if(ladder.begin(), ladder.end(), [&](size_t cell) {
    return scores[cell].incorrect > 0 || scores[cell].untrained.value_or(0) > 0;
  });
}

bool beats(const SweepScore& a, const SweepScore& b) {
  return a.correct >= b.correct && a.incorrect <= b.incorrect &&
         (a.correct > b.correct || a.incorrect < b.incorrect);
}

std::vector<size_t> pareto_front(std::span<const SweepScore> scores) {
  std::vector<size_t> front;
  for (size_t i = 0; i < scores.size(); ++i)
    if (std::none_of(scores.begin(), scores.end(),
                     [&](const SweepScore& other) { return beats(other, scores[i]); }))
      front.push_back(i);
  return front;
}

// Ladders are visited from the shortest window and the strictest threshold on: of equals the first
// stays.
void keep_better(std::optional<size_t>& kept, size_t cell, std::span<const SweepScore> scores) {
  if (scores[cell].correct == 0) return;
  if (!kept || scores[cell].correct > scores[*kept].correct) kept = cell;
}

// Why no setting is recommended, though the grid has numbers.
Advice missing_advice(std::span<const SweepScore> scores) {
  const auto any = [&](uint64_t SweepScore::*count) {
    return std::any_of(scores.begin(), scores.end(), [&](const SweepScore& score) {
      return score.looseness && score.*count > 0;
    });
  };
  if (any(&SweepScore::correct)) return Advice::always_errors;
  return any(&SweepScore::incorrect) ? Advice::no_correct_hits : Advice::no_hits;
}

}  // namespace

SweepScore score_of(const CellCounts& cell, ScoreOrder order) {
  SweepScore score{
      cell.counts.hits.correct, cell.counts.hits.incorrect, cell.window, {}, cell.untrained};
  if (cell.threshold)
    score.looseness = order == ScoreOrder::distance ? *cell.threshold : -*cell.threshold;
  return score;
}

Recommendation recommend(std::span<const CellCounts> cells, ScoreOrder order) {
  std::vector<SweepScore> scores;
  for (const CellCounts& cell : cells) scores.push_back(score_of(cell, order));
  return recommend(scores);
}

Recommendation recommend(std::span<const SweepScore> scores) {
  Recommendation choice;
  choice.pareto = pareto_front(scores);
  const std::map<uint64_t, Ladder> ladders = ladders_of(scores);
  if (ladders.empty()) {
    choice.advice = scores.empty() ? Advice::no_hits : Advice::only_automatic;
    return choice;
  }
  for (const auto& [window, ladder] : ladders) {
    const auto error = find_first_error(ladder, scores);
    for (auto cell = ladder.begin(); cell != error; ++cell) {
      const bool is_last = cell + 1 == error && !scores[*cell].untrained;
      keep_better(is_last ? choice.near_miss : choice.cell, *cell, scores);
    }
  }
  choice.advice = choice.cell ? Advice::recommended : missing_advice(scores);
  if (choice.cell) choice.near_miss.reset();
  const auto& named = choice.cell ? choice.cell : choice.near_miss;
  if (!named) return choice;
  const Ladder& ladder = ladders.at(scores[*named].window);
  const auto error = find_first_error(ladder, scores);
  if (error != ladder.end()) choice.first_error = *error;
  if (!choice.cell) choice.advice = choice.first_error ? Advice::next_errs : Advice::grid_ends;
  return choice;
}

}  // namespace vpr
