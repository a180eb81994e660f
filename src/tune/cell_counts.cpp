#include "tune/cell_counts.h"

#include <algorithm>
#include <map>

namespace vpr {
namespace {

bool has_error(const CellCounts& cell) {
  return cell.counts.recognitions.incorrect > 0 || cell.unknown_place.value_or(0) > 0;
}

bool is_superior(const LabelCounts& a, const LabelCounts& b) {
  return a.correct >= b.correct && a.incorrect <= b.incorrect &&
         (a.correct > b.correct || a.incorrect < b.incorrect);
}

// The reason for which no cell with a threshold is recommended.
Advice missing_advice(std::span<const CellCounts> cells) {
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

size_t best_counts(std::span<const FrameCounts> counts, uint64_t max_incorrect) {
  const auto is_better = [&](const FrameCounts& a, const FrameCounts& b) {
    const bool is_allowed = a.incorrect() <= max_incorrect;
    if (is_allowed != (b.incorrect() <= max_incorrect)) return is_allowed;
    const auto rank = [&](const FrameCounts& one) {
      const auto loss = -static_cast<int64_t>(one.path.correct);
      const auto incorrect = static_cast<int64_t>(one.incorrect());
      return is_allowed ? std::pair(loss, incorrect) : std::pair(incorrect, loss);
    };
    return rank(a) < rank(b);
  };
  return static_cast<size_t>(std::ranges::min_element(counts, is_better) - counts.begin());
}

Recommendation recommend(std::span<const CellCounts> cells, ScoreOrder order) {
  Recommendation choice;
  std::map<uint64_t, std::vector<size_t>> by_window;  // cells with a threshold
  for (size_t i = 0; i < cells.size(); ++i) {
    if (cells[i].threshold) by_window[cells[i].window].push_back(i);
    if (std::ranges::none_of(cells, [&](const CellCounts& other) {
          return is_superior(other.counts.recognitions, cells[i].counts.recognitions);
        }))
      choice.pareto.push_back(i);
  }
  if (by_window.empty()) {
    choice.advice = cells.empty() ? Advice::no_recognitions : Advice::only_automatic;
    return choice;
  }
  std::map<uint64_t, size_t> first_errors;  // by window
  for (auto& [window, thresholds] : by_window) {
    std::ranges::stable_sort(thresholds, {},
                             [&](size_t cell) { return *looseness_of(cells[cell], order); });
    const auto error =
        std::ranges::find_if(thresholds, [&](size_t cell) { return has_error(cells[cell]); });
    if (error != thresholds.end()) first_errors[window] = *error;
    for (auto cell = thresholds.begin(); cell != error; ++cell) {
      const bool is_last = cell + 1 == error && !cells[*cell].unknown_place;
      std::optional<size_t>& best = is_last ? choice.near_miss : choice.cell;
      const uint64_t least = best ? cells[*best].counts.recognitions.correct : 0;
      if (cells[*cell].counts.recognitions.correct > least) best = *cell;  // ties to the first
    }
  }
  choice.advice = choice.cell ? Advice::recommended : missing_advice(cells);
  if (choice.cell) choice.near_miss.reset();
  const auto& named = choice.cell ? choice.cell : choice.near_miss;
  if (!named) return choice;
  if (const auto error = first_errors.find(cells[*named].window); error != first_errors.end())
    choice.first_error = error->second;
  if (!choice.cell) choice.advice = choice.first_error ? Advice::next_errs : Advice::grid_ends;
  return choice;
}

}  // namespace vpr
