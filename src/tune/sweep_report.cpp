#include "tune/sweep_report.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "base/json_schema.h"
#include "base/text.h"
#include "evaluate/report_fields.h"
#include "present/evaluation_text.h"
#include "present/summary.h"
#include "recordings/sequence_json.h"

namespace vpr {
namespace {

/// A cell of a grid on one query.
struct SweepCell {
  std::string query;
  std::string window_symbol = "c_l";
  std::string threshold_symbol = "t_r";
  CellCounts cell;
};

template <class Visitor>
void visit_fields(SweepCell& of, Visitor&& visit) {
  CellCounts& cell = of.cell;
  visit("query", of.query, "Name of the query.");
  visit(of.window_symbol, cell.window,
        "Window length in frames; c_w of FAB-MAP: consecutive frames.", at_least(1));
  visit(of.threshold_symbol,
        CustomField{
            [&](Json& json, const std::string& key) { json[key] = value_to_json(cell.threshold); },
            [](const Fields&, const std::string&) {}},
        "Threshold of recognitions, or required margin.", kAs<InForce<std::optional<double>>>);
  visit("t_r_scale", IfSet{cell.scale}, "Scale of t_r.");
  visit("counts", cell.counts, "Counts of matches and places by ground truth.");
  visit("unknown_place", IfSet{cell.unknown_place},
        "Query windows that would be recognitions if their place were not trained.");
  BestMatchCounts& best = cell.counts.best_match;
  visit("best_match", NestedObject{[&](auto&& inner) {
          inner("frames", best.frames, "Query frames with a match in the ground truth.");
          inner("correct", best.correct, "Frames whose best match is correct.");
          inner("incorrect", best.incorrect, "Frames whose best match is incorrect.");
        }},
        "Query frames by the verdict on their best match, whatever its score.");
}

using Ends = std::array<double, 2>;

struct ReportedIntervals {
  size_t block = 1;
  Ends correct_recognitions = {}, incorrect_recognitions = {};
  std::optional<Ends> correct_clusters, incorrect_clusters;
};

template <class Visitor>
void visit_fields(ReportedIntervals& intervals, Visitor&& visit) {
  visit("block", intervals.block, "Windows per block.", at_least(1));
  visit("correct_recognitions", intervals.correct_recognitions, "Correct recognitions.");
  visit("incorrect_recognitions", intervals.incorrect_recognitions, "Incorrect recognitions.");
  visit("correct_clusters", IfSet{intervals.correct_clusters}, "Correct places.");
  visit("incorrect_clusters", IfSet{intervals.incorrect_clusters}, "Incorrect places.");
}

/// A query, and the conclusion from its cells.
struct SweepQuery {
  std::string name, ground_truth, reason;
  Json recommended_settings;
  Recommendation choice;  ///< with indices of all cells
  Selection selection;
  std::optional<ReportedIntervals> intervals;
  std::optional<SweepCell> validation;
};

template <class Visitor>
void visit_fields(SweepQuery& query, Visitor&& visit) {
  Recommendation& choice = query.choice;
  visit("name", query.name, "Name of the query.");
  visit("ground_truth", query.ground_truth, "Definition, in words.");
  visit("recommended", choice.cell,
        "Index in cells: most correct recognitions, and no incorrect recognition up to the next "
        "looser threshold; null: none.");
  visit("recommended_settings", Derived{query.recommended_settings},
        "Settings of the recommended cell, for --config; null: none.", kOrNull);
  visit("advice", choice.advice, "Why a setting is recommended, or is not.");
  visit("reason", query.reason, "The advice in words.");
  visit("near_miss", choice.near_miss,
        "Index in cells: most correct recognitions without an incorrect one, but the next looser "
        "threshold has one.");
  visit("nearest_error", choice.first_error, "Index in cells: strictest threshold with an error.");
  visit("pareto", choice.pareto,
        "Indices in cells: settings that no other beats in correct and incorrect recognitions.");
  visit_fields(query.selection, visit);
  visit("intervals", IfSet{query.intervals},
        "95 % intervals of the recommended setting, by the block bootstrap over query windows; "
        "absent without a recommendation.");
  visit("validation", IfSet{query.validation}, "Counts on the query of --validate.");
}

struct SweepFile {
  std::string method;
  Json settings;
  std::vector<SweepCell> cells;
  std::vector<SweepQuery> queries;
  Provenance provenance;
};

VPR_FILE(SweepFile, "sweep", (method, "fastable or fabmap."),
         (settings, "Settings that can change the numbers; keys are the names of flags."),
         (cells, "One per setting and query."),
         (queries, "Queries of the sweep, and the recommended cell of each."),
         (provenance, kProvenanceText))

SweepCell named_cell(const std::string& query, const CellCounts& cell, const Sweep& sweep) {
  return {query, std::string(sweep.score->window_symbol), sweep.threshold_symbol, cell};
}

// `first`: the index of the sweep's first cell among those of all sweeps.
SweepQuery sweep_query(const Sweep& sweep, size_t first) {
  SweepQuery query{sweep.query.name,
                   sweep.protocol,
                   reason_text(sweep),
                   {},
                   sweep.recommendation,
                   sweep.query.selection,
                   {},
                   {}};
  Recommendation& choice = query.choice;
  for (std::optional<size_t>* cell : {&choice.cell, &choice.near_miss, &choice.first_error})
    if (*cell) **cell += first;
  for (size_t& cell : choice.pareto) cell += first;
  if (sweep.recommended_settings)
    query.recommended_settings = settings_in_force(*sweep.recommended_settings);
  if (const auto& found = sweep.intervals) {
    const auto ends = [](const Interval& interval) { return Ends{interval.low, interval.high}; };
    query.intervals = ReportedIntervals{found->block,
                                        ends(found->correct_recognitions),
                                        ends(found->incorrect_recognitions),
                                        {},
                                        {}};
    if (sweep.cells.front().counts.clusters) {
      query.intervals->correct_clusters = ends(found->correct_clusters);
      query.intervals->incorrect_clusters = ends(found->incorrect_clusters);
    }
  }
  if (sweep.validation)
    query.validation = named_cell(sweep.validation->query_name, sweep.validation->cell, sweep);
  return query;
}

bool has_places(const Sweep& sweep) { return sweep.cells.front().counts.clusters.has_value(); }

std::string cell_name(const Sweep& sweep, const CellCounts& cell) {
  const std::string scale = cell.scale ? fmt::format(" ({})", enum_name(*cell.scale)) : "";
  return fmt::format("{} {}, {} {}{}", sweep.score->window_symbol, cell.window,
                     sweep.threshold_symbol, threshold_text(cell), scale);
}

/// The correct and the incorrect count of a cell.
using CellTexts = std::array<std::string, 2> (*)(const Counts&);

std::array<std::string, 2> label_texts(const LabelCounts& counts, const std::string& more = "") {
  return {std::to_string(counts.correct) + more, std::to_string(counts.incorrect)};
}

// A row per query and threshold, or per query for counts that do not depend on the threshold.
Table grid_table(const std::vector<Sweep>& sweeps, const std::string& title, CellTexts texts,
                 bool every_threshold, bool star) {
  Table table;
  table.title = sweeps.size() > 1 ? title : sweeps.front().query.name + ": " + title;
  if (sweeps.size() > 1) table.columns.emplace_back("query");
  if (every_threshold) table.columns.push_back(sweeps.front().threshold_symbol);
  for (const std::string& window : distinct_texts(sweeps.front(), window_text))
    table.columns.insert(table.columns.end(), {window + " correct", window + " incorrect"});
  for (const Sweep& sweep : sweeps) {
    for (const std::string& threshold : distinct_texts(sweep, threshold_text)) {
      std::vector<std::string>& row = table.rows.emplace_back();
      if (sweeps.size() > 1) row.push_back(sweep.query.name);
      if (every_threshold) row.push_back(threshold);
      for (size_t c = 0; c < sweep.cells.size(); ++c) {
        if (threshold_text(sweep.cells[c]) != threshold) continue;
        auto [right, wrong] = texts(sweep.cells[c].counts);
        if (star && sweep.recommendation.cell == c) right += "*";
        row.insert(row.end(), {right, wrong});
      }
      if (!every_threshold) break;
    }
  }
  return table;
}

std::string first_error_text(const Sweep& sweep) {
  const Recommendation& choice = sweep.recommendation;
  const std::string window =
      fmt::format("{} {}", sweep.score->window_symbol, sweep.cells[*choice.cell].window);
  if (!choice.first_error) return fmt::format("{} has no error in the whole grid.", window);
  const CellCounts& error = sweep.cells[*choice.first_error];
  const LabelCounts& recognitions = error.counts.recognitions;
  const std::string setting = fmt::format("{} {}", sweep.threshold_symbol, threshold_text(error));
  if (recognitions.incorrect == 0)
    return fmt::format(
        "At {}, {} would be accepted at a wrong place if their own place were not trained.",
        setting, counted(*error.unknown_place, "window"));
  return fmt::format(
      "The first error of {} is at {}, where {} of the {} accepted pairs {} incorrect.", window,
      setting, recognitions.incorrect,
      recognitions.correct + recognitions.incorrect + recognitions.ignored,
      recognitions.incorrect == 1 ? "is" : "are");
}

// A line about the filter if it recognizes more frames correctly than `path` and no more
// incorrectly, or if `path` is unset.
std::string filter_text(const Sweep& sweep, const std::optional<Localization>& path) {
  if (!sweep.filter) return {};
  const Localization& filter = *sweep.filter;
  if (path && (filter.correct <= path->correct || filter.incorrect > path->incorrect)) return {};
  if (path)
    return wrapped_text(
        fmt::format("The default of vpr-query, the filter, recognizes {} correctly and {} "
                    "incorrectly.",
                    filter.correct, filter.incorrect),
        2);
  if (!sweep.advice.empty()) return wrapped_text(sweep.advice, 2);
  std::string text =
      fmt::format("The filter recognizes {}.", frame_counts_text({filter, {}}, false));
  if (filter.correct > 0 && filter.incorrect == 0)
    text += " Use the filter: vpr-query without flags of windows.";
  return wrapped_text(text, 2);
}

std::string counts_text(const Sweep& sweep, const CellCounts& cell) {
  return frame_counts_text({cell.path, cell.counts.recognitions},
                           sweep.score == &probability_kind());
}

bool knows_untrained(const Sweep& sweep) {
  return std::ranges::any_of(sweep.cells, &std::optional<uint64_t>::has_value,
                             &CellCounts::unknown_place);
}

std::string intervals_text(const SweepIntervals& intervals, bool with_places) {
  const auto range = [](const Interval& interval) {
    return fmt::format("{:.0f} to {:.0f}", interval.low, interval.high);
  };
  std::string text =
      fmt::format("Accepted pairs: correct {}, incorrect {}", range(intervals.correct_recognitions),
                  range(intervals.incorrect_recognitions));
  if (with_places)
    text += fmt::format("; places: correct {}, incorrect {}", range(intervals.correct_clusters),
                        range(intervals.incorrect_clusters));
  return text + fmt::format(" (95 %, blocks of {}).", counted(intervals.block, "frame"));
}

}  // namespace

std::string window_text(const CellCounts& cell) { return std::to_string(cell.window); }

std::string threshold_text(const CellCounts& cell) {
  return cell.threshold ? fmt::format("{}", *cell.threshold) : "auto";
}

std::vector<std::string> distinct_texts(const Sweep& sweep,
                                        std::string (*text)(const CellCounts&)) {
  std::vector<std::string> values;
  for (const CellCounts& cell : sweep.cells)
    if (std::ranges::find(values, text(cell)) == values.end()) values.push_back(text(cell));
  return values;
}

Json sweep_json(std::string_view method, const QuerySettings& base,
                const std::vector<Sweep>& sweeps, const RunInfo& run, double seconds) {
  SweepFile file{std::string(method), settings_in_force(base), {}, {}, provenance_of(run)};
  for (const Sweep& sweep : sweeps)
    for (const std::string& varied :
         {std::string(sweep.score->window_symbol), sweep.threshold_symbol})
      file.settings.erase(varied);
  for (const Sweep& sweep : sweeps) {
    file.queries.push_back(sweep_query(sweep, file.cells.size()));
    for (const CellCounts& cell : sweep.cells)
      file.cells.push_back(named_cell(sweep.query.name, cell, sweep));
  }
  Json json = value_to_json(file, kDataForm);
  add_run(json, run, {{"sweep", seconds}});
  return json;
}

Json sweep_schema() {
  Json schema = with_run(schema_of<SweepFile>());
  std::vector<Json> cells;
  constexpr std::array<std::array<const char*, 2>, 3> kSymbols = {
      {{"c_l", "t_r"}, {"c_l", "margin"}, {"c_w", "t_p"}}};
  for (const auto& [window, threshold] : kSymbols) {
    SweepCell cell{{}, window, threshold, {}};
    cells.push_back(field_schema(cell, SchemaForm::data));
  }
  Json& properties = schema["properties"];
  properties["cells"]["items"] = {{"anyOf", cells}};
  properties["queries"]["items"]["properties"]["validation"] = {
      {"description", "Counts on the query of --validate."}, {"anyOf", cells}};
  return schema;
}

std::string config_text(const QuerySettings& settings) {
  Json json = {{"schema", schema_name("config")}};
  json.update(settings_in_force(settings));
  return to_text(json);
}

std::vector<Table> sweep_tables(const std::vector<Sweep>& sweeps) {
  const Sweep& first = sweeps.front();
  const bool any_star = std::ranges::any_of(
      sweeps, [](const Sweep& sweep) { return sweep.recommendation.cell.has_value(); });
  std::vector<Table> tables = {grid_table(
      sweeps,
      fmt::format("accepted pairs by {} and {}{}", first.threshold_symbol,
                  first.score->window_symbol, any_star ? " (* recommended)" : ""),
      [](const Counts& counts) { return label_texts(counts.recognitions); }, true, true)};
  const bool any_mixed = std::ranges::any_of(sweeps, [](const Sweep& sweep) {
    return std::ranges::any_of(
        sweep.cells, [](const CellCounts& cell) { return cell.counts.mixed_clusters > 0; });
  });
  if (has_places(first))
    tables.push_back(grid_table(
        sweeps,
        any_mixed ? "places, judged at their mean (in brackets: with incorrect recognitions)"
                  : "places",
        [](const Counts& counts) {
          const uint64_t mixed = counts.mixed_clusters.value_or(0);
          return label_texts(*counts.clusters, mixed > 0 ? fmt::format(" ({})", mixed) : "");
        },
        true, false));
  tables.push_back(grid_table(
      sweeps, fmt::format("best matches by {}", first.score->window_symbol),
      [](const Counts& counts) {
        const BestMatchCounts& best = counts.best_match;
        return label_texts({best.correct, best.incorrect, 0});
      },
      false, false));
  return tables;
}

Table cells_table(const std::vector<Sweep>& sweeps) {
  Table table;
  for (const std::string_view column :
       split("query,,,scale,pairs_correct,pairs_incorrect,pairs_ignored,"
             "pairs_by_cluster_correct,pairs_by_cluster_incorrect,pairs_by_cluster_ignored,"
             "clusters_correct,clusters_mixed,clusters_incorrect,clusters_ignored,"
             "distinct,best_match_correct,best_match_incorrect,frames_with_match,"
             "pareto,recommended",
             ','))
    table.columns.emplace_back(column);
  table.columns[1] = sweeps.front().score->window_symbol;
  table.columns[2] = sweeps.front().threshold_symbol;
  for (const Sweep& sweep : sweeps)
    for (size_t c = 0; c < sweep.cells.size(); ++c) {
      const CellCounts& cell = sweep.cells[c];
      const auto& [recognitions, by_place, places, mixed, distinct, best] = cell.counts;
      const Recommendation& choice = sweep.recommendation;
      const auto of_places = [has_places = places.has_value()](uint64_t count) {
        return has_places ? std::to_string(count) : "";
      };
      const LabelCounts pairs = by_place.value_or(LabelCounts{});
      const LabelCounts judged = places.value_or(LabelCounts{});
      const bool is_pareto = std::ranges::find(choice.pareto, c) != choice.pareto.end();
      add_row(table, sweep.query.name, cell.window, threshold_text(cell),
              cell.scale ? enum_name(*cell.scale) : sweep.score->measure, recognitions.correct,
              recognitions.incorrect, recognitions.ignored, of_places(pairs.correct),
              of_places(pairs.incorrect), of_places(pairs.ignored), of_places(judged.correct),
              of_places(mixed.value_or(0)), of_places(judged.incorrect), of_places(judged.ignored),
              distinct, best.correct, best.incorrect, best.frames, is_pareto ? "yes" : "no",
              choice.cell == c ? "yes" : "no");
    }
  return table;
}

std::string reason_text(const Sweep& sweep) {
  const Recommendation& choice = sweep.recommendation;
  const std::string& symbol = sweep.threshold_symbol;
  const std::string near_miss =
      choice.near_miss
          ? fmt::format("{} has no error", cell_name(sweep, sweep.cells[*choice.near_miss]))
          : "";
  switch (choice.advice) {
    case Advice::recommended:
      if (sweep.cells[*choice.cell].unknown_place)
        return "it accepts the most correct pairs of all numbers of the grid without an error, "
               "even when each place is removed from the training sequences";
      return fmt::format(
          "it accepts the most correct pairs of all numbers of the grid without an error at this, "
          "every stricter and the next looser {}",
          symbol);
    case Advice::no_recognitions:
      return "no setting recognizes a frame";
    case Advice::no_correct_recognitions:
      return "all recognitions are incorrect; check that the ground truth belongs to this query";
    case Advice::always_errors:
      return fmt::format("every setting that recognizes a frame correctly also has an error{}",
                         knows_untrained(sweep) ? ", or would if its place were not trained" : "");
    case Advice::next_errs:
      return fmt::format("{}, but the next looser {} of the grid, {}, has one", near_miss, symbol,
                         threshold_text(sweep.cells[*choice.first_error]));
    case Advice::grid_ends:
      return fmt::format("{}, but the grid has no looser {} that shows how near the first error is",
                         near_miss, symbol);
    case Advice::only_automatic:
      return fmt::format("an automatic {} has no next looser one to compare with; add numbers",
                         symbol);
  }
  return {};
}

Table best_cells_table(const Sweep& sweep) {
  constexpr size_t kMostRows = 10;
  const std::optional<size_t>& recommended = sweep.recommendation.cell;
  const std::string& symbol = sweep.threshold_symbol;
  Table table;
  table.title = fmt::format("{}: best {} of each {}, over {} with a match{}", sweep.query.name,
                            symbol, sweep.score->window_symbol,
                            counted(sweep.cells.front().counts.best_match.frames, "frame"),
                            recommended ? " (* recommended)" : "");
  table.columns = {std::string(sweep.score->window_symbol), symbol, "correct", "incorrect",
                   "pairs incorrect"};
  for (size_t first = 0, end = 0; first < sweep.cells.size(); first = end) {
    std::vector<FrameCounts> counts;
    for (; end < sweep.cells.size() && sweep.cells[end].window == sweep.cells[first].window; ++end)
      counts.push_back({sweep.cells[end].path, sweep.cells[end].counts.recognitions});
    const size_t best = first + best_counts(counts, 0);
    const bool has_room = table.rows.size() < kMostRows;
    for (size_t c = first; c < end; ++c)
      if (const CellCounts& cell = sweep.cells[c]; (c == best && has_room) || c == recommended)
        add_row(table, window_text(cell) + (c == recommended ? "*" : ""), threshold_text(cell),
                cell.path.correct, cell.path.incorrect, cell.counts.recognitions.incorrect);
  }
  return table;
}

std::string recommendation_text(const Sweep& sweep, bool with_intervals) {
  const Recommendation& choice = sweep.recommendation;
  if (!choice.cell)
    return wrapped_text(fmt::format("No recommendation: {}.", reason_text(sweep)), 2) +
           filter_text(sweep, {});
  const CellCounts& cell = sweep.cells[*choice.cell];
  std::string text = wrapped_text(fmt::format("Recommended: {}: {}; {}.", cell_name(sweep, cell),
                                              counts_text(sweep, cell), reason_text(sweep)),
                                  2);
  text += wrapped_text(first_error_text(sweep), 2);
  if (sweep.intervals && with_intervals)
    text += wrapped_text(intervals_text(*sweep.intervals, has_places(sweep)), 2);
  const std::string filter = filter_text(sweep, cell.path);
  const bool may_generalize = sweep.score == &probability_kind() || knows_untrained(sweep);
  return text + (!filter.empty()  ? filter
                 : may_generalize ? "It may be wrong on another sequence.\n"
                                  : "It may be wrong on another sequence: --decide margin "
                                    "generalizes better.\n");
}

std::string validation_text(const Sweep& sweep) {
  return wrapped_text(fmt::format("On the validation, {}: {}.", sweep.validation->query_name,
                                  counts_text(sweep, sweep.validation->cell)),
                      2);
}

}  // namespace vpr
