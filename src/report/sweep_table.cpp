#include "report/sweep_table.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/text.h"

namespace vpr {
namespace {

std::string number(double value) { return fmt::format("{}", value); }

bool has_places(const Sweep& sweep) { return sweep.cells.front().counts.clusters.has_value(); }

std::string cell_name(const Sweep& sweep, size_t index) {
  const SweepCell cell = sweep_cells(sweep)[index];
  const SweepSymbols symbols = sweep_symbols(sweep);
  const bool has_scale = sweep.cells[index].scale.has_value();
  const std::string scale = has_scale ? fmt::format(" ({})", cell.scale) : "";
  return fmt::format("{} {}, {} {}{}", symbols.window, cell.window, symbols.threshold,
                     cell.threshold, scale);
}

/// The two texts of a cell in a table.
using CellTexts = std::pair<std::string, std::string> (*)(const SweepCell&);

std::pair<std::string, std::string> hit_texts(const SweepCell& cell) {
  return {std::to_string(cell.hits.correct), std::to_string(cell.hits.incorrect)};
}

std::pair<std::string, std::string> place_texts(const SweepCell& cell) {
  const std::string mixed = cell.mixed_places > 0 ? fmt::format(" ({})", cell.mixed_places) : "";
  return {std::to_string(cell.places->correct) + mixed, std::to_string(cell.places->incorrect)};
}

std::pair<std::string, std::string> best_texts(const SweepCell& cell) {
  const BestMatchCounts& best = cell.best_match;
  return {std::to_string(best.correct), std::to_string(best.queries - best.ignored - best.correct)};
}

// A row of each query for each of the thresholds, or for the first of them.
Table grid_table(const std::vector<Sweep>& sweeps, const std::string& title, CellTexts texts,
                 bool every_threshold, bool star) {
  const SweepSymbols symbols = sweep_symbols(sweeps.front());
  Table table;
  table.title = sweeps.size() > 1 ? title : sweeps.front().query_name + ": " + title;
  if (sweeps.size() > 1) table.columns.emplace_back("query");
  if (every_threshold) table.columns.push_back(symbols.threshold);
  for (const std::string& window : distinct_values(sweep_cells(sweeps.front()), &SweepCell::window))
    table.columns.insert(table.columns.end(), {window + " right", window + " wrong"});
  for (const Sweep& sweep : sweeps) {
    const std::vector<SweepCell> cells = sweep_cells(sweep);
    for (const std::string& threshold : distinct_values(cells, &SweepCell::threshold)) {
      std::vector<std::string>& row = table.rows.emplace_back();
      if (sweeps.size() > 1) row.push_back(sweep.query_name);
      if (every_threshold) row.push_back(threshold);
      for (size_t c = 0; c < cells.size(); ++c) {
        if (cells[c].threshold != threshold) continue;
        auto [right, wrong] = texts(cells[c]);
        if (star && sweep.recommendation.cell == c) right += "*";
        row.insert(row.end(), {right, wrong});
      }
      if (!every_threshold) break;
    }
  }
  return table;
}

std::string first_error_text(const Sweep& sweep) {
  const SweepSymbols symbols = sweep_symbols(sweep);
  const Recommendation& choice = sweep.recommendation;
  const std::vector<SweepCell> cells = sweep_cells(sweep);
  const std::string& window = cells[*choice.cell].window;
  if (!choice.first_error)
    return fmt::format("{} {} has no incorrect hit in the whole grid.\n", symbols.window, window);
  const SweepCell& error = cells[*choice.first_error];
  if (error.hits.incorrect == 0)
    return fmt::format("At {} {}, {} of {} {} would be wrong, were their places not trained.\n",
                       symbols.threshold, error.threshold, counted(*error.untrained, "window"),
                       symbols.window, window);
  return fmt::format("The first error of {} {} is at {} {}: {}, {} correct.\n", symbols.window,
                     window, symbols.threshold, error.threshold,
                     counted(error.hits.incorrect, "incorrect hit"), error.hits.correct);
}

// Whether cells know what windows would reach were their places not trained.
bool knows_untrained(const Sweep& sweep) {
  return std::any_of(sweep.cells.begin(), sweep.cells.end(),
                     [](const CellCounts& cell) { return cell.untrained.has_value(); });
}

// A recommendation holds on what it was not made from, or says that it may not.
std::string promise_text(const Sweep& sweep) {
  if (sweep.score == &probability_kind() || knows_untrained(sweep))
    return "It may be wrong on another sequence.\n";
  return "It may be wrong on another sequence: --decide margin generalizes better.\n";
}

std::string intervals_text(const SweepIntervals& intervals, bool has_places) {
  const auto range = [](const Interval& interval) {
    return fmt::format("{:.0f} to {:.0f}", interval.low, interval.high);
  };
  std::string text = fmt::format("Correct hits {}, incorrect {}", range(intervals.correct_hits),
                                 range(intervals.incorrect_hits));
  if (has_places)
    text += fmt::format("; correct places {}, incorrect {}", range(intervals.correct_places),
                        range(intervals.incorrect_places));
  return text + fmt::format(" (95 %, blocks of {}).\n", counted(intervals.block, "frame"));
}

}  // namespace

std::vector<SweepCell> sweep_cells(const Sweep& sweep) {
  std::vector<SweepCell> cells;
  for (const CellCounts& cell : sweep.cells)
    cells.push_back({std::to_string(cell.window), cell.threshold ? number(*cell.threshold) : "auto",
                     looseness_of(cell, sweep.threshold_order),
                     std::string(cell.scale ? enum_name(*cell.scale) : sweep.score->measure),
                     cell.counts.hits, cell.counts.clusters, cell.counts.mixed_clusters,
                     cell.counts.distinct, cell.counts.best_match, cell.untrained});
  return cells;
}

SweepSymbols sweep_symbols(const Sweep& sweep) {
  return {std::string(sweep.score->window_symbol), sweep.threshold_symbol};
}

std::vector<std::string> distinct_values(const std::vector<SweepCell>& cells,
                                         std::string SweepCell::*value) {
  std::vector<std::string> values;
  for (const SweepCell& cell : cells)
    if (std::find(values.begin(), values.end(), cell.*value) == values.end())
      values.push_back(cell.*value);
  return values;
}

std::vector<Table> sweep_tables(const std::vector<Sweep>& sweeps) {
  const SweepSymbols symbols = sweep_symbols(sweeps.front());
  const bool any_star = std::any_of(sweeps.begin(), sweeps.end(), [](const Sweep& sweep) {
    return sweep.recommendation.cell.has_value();
  });
  std::vector<Table> tables = {
      grid_table(sweeps,
                 fmt::format("hits by {} and {}{}", symbols.threshold, symbols.window,
                             any_star ? " (* recommended)" : ""),
                 hit_texts, true, true)};
  const bool any_mixed = std::any_of(sweeps.begin(), sweeps.end(), [](const Sweep& sweep) {
    const std::vector<SweepCell> cells = sweep_cells(sweep);
    return std::any_of(cells.begin(), cells.end(),
                       [](const SweepCell& cell) { return cell.mixed_places > 0; });
  });
  if (has_places(sweeps.front()))
    tables.push_back(grid_table(
        sweeps,
        any_mixed ? "places, judged at their mean (in brackets: right there, but with wrong hits)"
                  : "places",
        place_texts, true, false));
  tables.push_back(grid_table(sweeps, fmt::format("best matches by {}", symbols.window), best_texts,
                              false, false));
  return tables;
}

Table cells_table(const std::vector<Sweep>& sweeps) {
  const SweepSymbols symbols = sweep_symbols(sweeps.front());
  Table table;
  table.columns = {"query",
                   symbols.window,
                   symbols.threshold,
                   "scale",
                   "hits_correct",
                   "hits_incorrect",
                   "hits_ignored",
                   "places_correct",
                   "places_mixed",
                   "places_incorrect",
                   "places_ignored",
                   "distinct",
                   "best_match_correct",
                   "best_match_queries",
                   "best_match_ignored",
                   "pareto",
                   "recommended"};
  for (const Sweep& sweep : sweeps) {
    const Recommendation& choice = sweep.recommendation;
    const std::vector<SweepCell> cells = sweep_cells(sweep);
    for (size_t c = 0; c < cells.size(); ++c) {
      const SweepCell& cell = cells[c];
      std::vector<std::string>& row = table.rows.emplace_back();
      row = {sweep.query_name, cell.window, cell.threshold, cell.scale};
      const auto add = [&](const std::optional<uint64_t>& count) {
        row.push_back(count ? std::to_string(*count) : "");
      };
      const auto of_places = [&](uint64_t count) {
        return cell.places ? std::optional(count) : std::nullopt;
      };
      const LabelCounts places = cell.places.value_or(LabelCounts{});
      for (const uint64_t count : {cell.hits.correct, cell.hits.incorrect, cell.hits.ignored})
        add(count);
      for (const uint64_t count :
           {places.correct, cell.mixed_places, places.incorrect, places.ignored})
        add(of_places(count));
      for (const uint64_t count : {cell.distinct, cell.best_match.correct, cell.best_match.queries,
                                   cell.best_match.ignored})
        add(count);
      const bool is_pareto =
          std::find(choice.pareto.begin(), choice.pareto.end(), c) != choice.pareto.end();
      row.insert(row.end(), {is_pareto ? "yes" : "no", choice.cell == c ? "yes" : "no"});
    }
  }
  return table;
}

std::string reason_text(const Sweep& sweep) {
  const Recommendation& choice = sweep.recommendation;
  const std::string threshold = sweep_symbols(sweep).threshold;
  const auto correct_at = [&](size_t cell) { return sweep_cells(sweep)[cell].hits.correct; };
  const auto near_miss = [&] {
    return fmt::format("{} has {} and no incorrect one", cell_name(sweep, *choice.near_miss),
                       counted(correct_at(*choice.near_miss), "correct hit"));
  };
  switch (choice.advice) {
    case Advice::recommended:
      if (sweep_cells(sweep)[*choice.cell].untrained)
        return fmt::format(
            "{}, the most of all settings that neither have an incorrect hit nor would, were the "
            "places not trained",
            counted(correct_at(*choice.cell), "correct hit"));
      return fmt::format(
          "{}, the most of all settings without an incorrect hit at "
          "this, every stricter and the next looser {}",
          counted(correct_at(*choice.cell), "correct hit"), threshold);
    case Advice::no_hits:
      return "no setting has a hit";
    case Advice::no_correct_hits:
      return "all hits are incorrect; check that the ground truth belongs to this query";
    case Advice::always_errors:
      return fmt::format("every setting with a correct hit also has an incorrect one{}",
                         knows_untrained(sweep) ? ", or would if its place were not trained" : "");
    case Advice::next_errs:
      return fmt::format("{}, but the next looser {} of the grid, {}, has one; add steps between",
                         near_miss(), threshold, sweep_cells(sweep)[*choice.first_error].threshold);
    case Advice::grid_ends:
      return fmt::format("{}, but the grid has no looser {} that shows how near the first error is",
                         near_miss(), threshold);
    case Advice::only_automatic:
      return fmt::format("an automatic {} has no next looser one to compare with; add numbers",
                         threshold);
  }
  return {};
}

std::string recommendation_text(const Sweep& sweep) {
  const Recommendation& choice = sweep.recommendation;
  if (!choice.cell)
    return fmt::format("{}: no recommendation: {}.\n", sweep.query_name, reason_text(sweep));
  std::string text = fmt::format("{}: recommended: {}: {}.\n", sweep.query_name,
                                 cell_name(sweep, *choice.cell), reason_text(sweep)) +
                     first_error_text(sweep);
  if (sweep.intervals) text += intervals_text(*sweep.intervals, has_places(sweep));
  return text + promise_text(sweep);
}

std::string validation_text(const ValidatedCell& validation) {
  const Counts& counts = validation.cell.counts;
  const auto pair_text = [](const LabelCounts& labels) {
    return fmt::format("{} right, {} wrong", labels.correct, labels.incorrect);
  };
  std::string text = fmt::format("On {}: hits {}", validation.query_name, pair_text(counts.hits));
  if (counts.clusters)
    text += fmt::format(
        "; places {}{}", pair_text(*counts.clusters),
        counts.mixed_clusters == 0
            ? ""
            : fmt::format(" ({} of the right ones with wrong hits)", counts.mixed_clusters));
  const BestMatchCounts& best = counts.best_match;
  return text +
         fmt::format("; best matches {} of {} right.\n", best.correct, best.queries - best.ignored);
}

}  // namespace vpr
