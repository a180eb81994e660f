#include "evaluate/sweep.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace vpr {
namespace {

using Cells = std::span<const CellCounts>;

/// Indices of the cells of one window whose thresholds are numbers, the strictest first.
using Ladder = std::vector<size_t>;

std::map<uint64_t, Ladder> ladders_of(Cells cells, ScoreOrder order) {
  std::map<uint64_t, Ladder> ladders;
  for (size_t i = 0; i < cells.size(); ++i)
    if (cells[i].threshold) ladders[cells[i].window].push_back(i);
  for (auto& entry : ladders)
    std::ranges::stable_sort(entry.second, {},
                             [&](size_t cell) { return *looseness_of(cells[cell], order); });
  return ladders;
}

Ladder::const_iterator find_first_error(const Ladder& ladder, Cells cells) {
  return std::ranges::find_if(ladder, [&](size_t cell) {
    return cells[cell].counts.recognitions.incorrect > 0 || cells[cell].untrained.value_or(0) > 0;
  });
}

bool beats(const LabelCounts& a, const LabelCounts& b) {
  return a.correct >= b.correct && a.incorrect <= b.incorrect &&
         (a.correct > b.correct || a.incorrect < b.incorrect);
}

std::vector<size_t> pareto_front(Cells cells) {
  std::vector<size_t> front;
  for (size_t i = 0; i < cells.size(); ++i)
    if (std::ranges::none_of(cells, [&](const CellCounts& other) {
          return beats(other.counts.recognitions, cells[i].counts.recognitions);
        }))
      front.push_back(i);
  return front;
}

// Ladders are visited from the shortest window and the strictest threshold on: of equals the first
// stays.
void keep_better(std::optional<size_t>& kept, size_t cell, Cells cells) {
  const auto correct = [&](size_t i) { return cells[i].counts.recognitions.correct; };
  if (correct(cell) > (kept ? correct(*kept) : 0)) kept = cell;
}

// Why no setting is recommended, though the grid has numbers.
Advice missing_advice(Cells cells) {
  const auto any = [&](uint64_t LabelCounts::*count) {
    return std::ranges::any_of(cells, [&](const CellCounts& cell) {
      return cell.threshold && cell.counts.recognitions.*count > 0;
    });
  };
  if (any(&LabelCounts::correct)) return Advice::always_errors;
  return any(&LabelCounts::incorrect) ? Advice::no_correct_recognitions : Advice::no_recognitions;
}

}  // namespace

std::optional<double> looseness_of(const CellCounts& cell, ScoreOrder order) {
  if (!cell.threshold) return std::nullopt;
  return order == ScoreOrder::distance ? *cell.threshold : -*cell.threshold;
}

Recommendation recommend(Cells cells, ScoreOrder order) {
  Recommendation choice;
  choice.pareto = pareto_front(cells);
  const std::map<uint64_t, Ladder> ladders = ladders_of(cells, order);
  if (ladders.empty()) {
    choice.advice = cells.empty() ? Advice::no_recognitions : Advice::only_automatic;
    return choice;
  }
  for (const auto& [window, ladder] : ladders) {
    const auto error = find_first_error(ladder, cells);
    for (auto cell = ladder.begin(); cell != error; ++cell) {
      const bool is_last = cell + 1 == error && !cells[*cell].untrained;
      keep_better(is_last ? choice.near_miss : choice.cell, *cell, cells);
    }
  }
  choice.advice = choice.cell ? Advice::recommended : missing_advice(cells);
  if (choice.cell) choice.near_miss.reset();
  const auto& named = choice.cell ? choice.cell : choice.near_miss;
  if (!named) return choice;
  const Ladder& ladder = ladders.at(cells[*named].window);
  const auto error = find_first_error(ladder, cells);
  if (error != ladder.end()) choice.first_error = *error;
  if (!choice.cell) choice.advice = choice.first_error ? Advice::next_errs : Advice::grid_ends;
  return choice;
}

}  // namespace vpr
