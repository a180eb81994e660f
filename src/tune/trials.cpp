#include "tune/trials.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json_schema.h"
#include "base/text.h"
#include "present/evaluation_text.h"
#include "present/result_text.h"
#include "present/summary.h"
#include "query/advice.h"
#include "query/train_sequences.h"
#include "recordings/sequence_json.h"

namespace vpr {
namespace {

const std::vector<std::optional<double>> kDistanceThresholds = {0.4,  0.45, 0.5,  0.55, 0.6,
                                                                0.65, 0.7,  0.75, 0.8};
const Grid kFabmapGrid = {{1, 2, 3}, {0.5, 0.7, 0.9, 0.99}};

FrameCounts sum_of(std::span<const FrameCounts> counts) {
  FrameCounts sum;
  sum.path.first_recognition_frames = 0;
  for (const auto& [path, pairs] : counts) {
    sum.path.frames += path.frames;
    sum.path.recognized += path.recognized;
    sum.path.frames_with_match += path.frames_with_match;
    sum.path.correct += path.correct;
    sum.path.incorrect += path.incorrect;
    sum.path.off_map += path.off_map;
    sum.pairs.correct += pairs.correct;
    sum.pairs.incorrect += pairs.incorrect;
    sum.pairs.ignored += pairs.ignored;
    std::optional<size_t>& first = sum.path.first_recognition_frames;
    if (first && path.first_recognition_frames)
      first = std::max(*first, *path.first_recognition_frames);
    else
      first.reset();
  }
  return sum;
}

// The index of the best cell over all queries. `sweep`: one query over the grid.
template <class Query, class SweepQuery>
size_t best_cell(const std::vector<Query>& queries, uint64_t max_incorrect,
                 const SweepQuery& sweep) {
  std::vector<std::vector<FrameCounts>> by_cell;
  for (const Query& query : queries) {
    const std::vector<CellCounts> cells = sweep(query).cells;
    by_cell.resize(cells.size());
    for (size_t c = 0; c < cells.size(); ++c)
      by_cell[c].push_back({cells[c].path, cells[c].counts.recognitions});
  }
  std::vector<FrameCounts> sums;
  for (const auto& counts : by_cell) sums.push_back(sum_of(counts));
  return best_counts(sums, max_incorrect);
}

// Counts the frames of all queries. `run`: one query with the settings of the trial.
template <class Query, class Run>
void run_trial(Trial& trial, const std::vector<Query>& queries, const Monitor& monitor,
               const Run& run) {
  for (const Query& query : queries) {
    QueryRun done = run(query);
    for (const auto& [step, seconds] : done.seconds) trial.seconds += seconds;
    trial.settings = done.result.settings;  // without features that the database lacks
    const Evaluation found = evaluate_result(std::make_shared<const Result>(std::move(done.result)),
                                             std::nullopt, query.by, monitor);
    require_all_pairs(found.truth, query.by);
    trial.counts.push_back({found.judgment.localization, found.result->counts.recognitions});
  }
}

std::string name_of(const SequenceQuerySettings& settings) {
  const Rule& rule = settings.rule;
  if (has_paths(rule)) return method_text(settings);
  if (decision_of(rule) == Decision::threshold)
    return fmt::format("FastABLE, c_l {}, t_r {:g}", window_length_of(rule), *limit_of(rule));
  return fmt::format("{}, c_l {}", method_text(settings), window_length_of(rule));
}

// The settings of the best cell over all queries.
SequenceQuerySettings best_windows(const SequenceDatabase& database,
                                   const std::vector<LabeledQuery>& queries,
                                   const SequenceQuerySettings& settings, const Grid& grid,
                                   uint64_t max_incorrect, const QueryResources& resources,
                                   const Monitor& monitor) {
  const size_t cell = best_cell(queries, max_incorrect, [&](const LabeledQuery& query) {
    return sweep_sequences(database, query, settings, grid, resources, monitor);
  });
  return settings_at(grid, cell, settings);
}

struct TriedQuery {
  std::string name;
  size_t frames = 0;
  Selection selection;
};

template <class Visitor>
void visit_fields(TriedQuery& query, Visitor&& visit) {
  visit("name", query.name, "Name of the query.");
  visit("frames", query.frames, "Number of frames.", at_least(1));
  visit_fields(query.selection, visit);
}

template <class Visitor>
void visit_counts(FrameCounts& counts, Visitor&& visit) {
  auto& [path, pairs] = counts;
  visit("frames", path.frames_with_match, "Query frames with a match in the ground truth.");
  visit("correct", path.correct, "Frames whose best accepted match is correct.");
  visit("incorrect", path.incorrect, "Frames whose best accepted match is incorrect.");
  visit("pairs_incorrect", pairs.incorrect, "Accepted pairs that are incorrect.");
  visit("first", path.first_recognition_frames,
        "Frames before the decision on the first correct recognition, of all queries the latest; "
        "null: a query has none.");
}

struct TrialInFile {
  FrameCounts total;
  std::string name;
  Json settings;
  std::vector<FrameCounts> queries;
};

template <class Visitor>
void visit_fields(TrialInFile& trial, Visitor&& visit) {
  visit_counts(trial.total, visit);
  visit("name", trial.name, "Name of the setting in tables.");
  visit("settings", trial.settings, "The setting; keys are the names of flags.");
  visit("queries",
        NestedList{trial.queries,
                   [](FrameCounts& counts, auto&& inner) { visit_counts(counts, inner); }},
        "Counts by query.");
}

struct TrialsFile {
  uint64_t max_incorrect = 0;
  std::vector<TriedQuery> queries;
  std::vector<TrialInFile> trials;
  std::optional<size_t> chosen;
  Json settings;
  Provenance provenance;
};

VPR_FILE(TrialsFile, "tuning", (max_incorrect, "Most incorrect frames, and pairs, of the choice."),
         (queries, "The labeled queries."),
         (trials, "One per setting, the simplest and most general rule first."),
         (chosen,
          "Index in trials: most correct frames with at most max_incorrect incorrect frames and "
          "pairs; null: none."),
         (settings, "Settings of the choice, for --config; null: none.", kOrNull),
         (provenance, kProvenanceText))

void add_counts(Table& table, const std::string& setting, const FrameCounts& counts,
                double seconds) {
  const auto& [path, pairs] = counts;
  add_row(table, setting, path.correct, path.incorrect, pairs.incorrect,
          path.first_recognition_frames ? std::to_string(*path.first_recognition_frames) : "-",
          fmt::format("{:.2f}", 1000 * seconds / static_cast<double>(path.frames)));
}

}  // namespace

FrameCounts Trial::total() const { return sum_of(counts); }

std::vector<uint64_t> fitting_lengths(std::vector<uint64_t> lengths,
                                      const SequenceDatabase& database,
                                      const std::vector<const DescriptorSet*>& queries) {
  const std::vector<DescribedFrames> spans = descriptor_spans(database);
  std::erase_if(lengths, [&](uint64_t length) {
    const auto has_no_window = [&](const DescribedFrames& frames) {
      return count_windows(readable_runs(frames), length) == 0;
    };
    return std::ranges::all_of(spans, has_no_window) ||
           std::ranges::any_of(
               queries, [&](const DescriptorSet* query) { return has_no_window(query->span()); });
  });
  return lengths;
}

Trial try_setting(const SequenceDatabase& database, const std::vector<LabeledQuery>& queries,
                  const SequenceQuerySettings& settings, const QueryResources& resources,
                  const Monitor& monitor) {
  const bool is_tuned = std::holds_alternative<Threshold>(settings.rule);
  Trial trial{name_of(settings), settings, is_tuned, {}, 0};
  const PreparedDatabase prepared = prepare(database, settings, resources, monitor);
  run_trial(trial, queries, monitor, [&](const LabeledQuery& query) {
    return run_query(plan_query(prepared, query.frames, query.name, settings, resources, monitor),
                     {}, monitor);
  });
  return trial;
}

Trials try_sequences(const SequenceDatabase& database, const std::vector<LabeledQuery>& queries,
                     const SequenceQuerySettings& base, uint64_t max_incorrect,
                     const QueryResources& resources, const Monitor& monitor) {
  const Monitor once = with_each_warning_once(monitor);  // most are the same for every setting
  const Monitor silent = {monitor.progress, {}, monitor.stop};
  Trials trials;
  trials.max_incorrect = max_incorrect;
  std::vector<const DescriptorSet*> frames;
  for (const LabeledQuery& query : queries) {
    trials.queries.push_back(query.frames.sequence);
    trials.queries.back().name = query.name;
    frames.push_back(&query.frames);
  }
  trials.all.push_back(try_setting(database, queries, default_filter(base), resources, once));

  const std::vector<uint64_t> lengths = fitting_lengths({10, 20, 40}, database, frames);
  const auto try_windows = [&](const Rule& rule, const Grid& grid) {
    if (lengths.empty()) return;
    SequenceQuerySettings windows = base;
    windows.rule = rule;
    try {
      const SequenceQuerySettings best =
          best_windows(database, queries, windows, grid, max_incorrect, resources, silent);
      trials.all.push_back(try_setting(database, queries, best, resources, silent));
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::usage) throw;
      warn(monitor, "A setting is not tried: {}", error.what());
    }
  };
  Margin scored;
  scored.windows.score = Score::zscore;
  Threshold raw;
  scored.windows.same_place = raw.windows.same_place = same_place_of(base.rule);
  try_windows(scored, {lengths, {std::nullopt}});
  try_windows(raw, {lengths, kDistanceThresholds});
  choose(trials);
  return trials;
}

Trial try_fabmap(const FabmapDatabase& database, const std::vector<LabeledWords>& queries,
                 const FabmapQuerySettings& base, uint64_t max_incorrect, uint64_t seed,
                 const Monitor& monitor) {
  const size_t cell = best_cell(queries, max_incorrect, [&](const LabeledWords& query) {
    return sweep_fabmap(database, query, base, kFabmapGrid, seed, monitor);
  });
  const FabmapQuerySettings settings = settings_at(kFabmapGrid, cell, base);
  Trial trial{fmt::format("FAB-MAP, c_w {}, t_p {:g}", settings.window, settings.place_threshold),
              settings,
              true,
              {},
              0};
  run_trial(trial, queries, monitor, [&](const LabeledWords& query) {
    return query_fabmap(database, query.frames, query.name, settings, seed, {}, monitor);
  });
  return trial;
}

void choose(Trials& trials) {
  trials.chosen.reset();
  for (const bool is_tuned : {false, true}) {
    std::vector<FrameCounts> totals;
    std::vector<size_t> numbers;
    for (size_t t = 0; t < trials.all.size(); ++t) {
      if (trials.all[t].is_tuned != is_tuned) continue;
      totals.push_back(trials.all[t].total());
      numbers.push_back(t);
    }
    if (totals.empty()) continue;
    const size_t best = best_counts(totals, trials.max_incorrect);
    if (totals[best].path.correct == 0 || totals[best].incorrect() > trials.max_incorrect) continue;
    trials.chosen = numbers[best];
    return;
  }
}

Json trials_json(const Trials& trials, const RunInfo& run, double seconds) {
  TrialsFile file{trials.max_incorrect, {}, {}, trials.chosen, {}, provenance_of(run)};
  for (const Sequence& query : trials.queries)
    file.queries.push_back({query.name, query.frames, query.selection});
  std::map<std::string, double> timing = {{"all", seconds}};
  for (const Trial& trial : trials.all) {
    file.trials.push_back(
        {trial.total(), trial.name, settings_in_force(trial.settings), trial.counts});
    timing[trial.name] = trial.seconds;
  }
  if (trials.chosen) file.settings = settings_in_force(trials.all[*trials.chosen].settings);
  Json json = value_to_json(file, kDataForm);
  add_run(json, run, timing);
  return json;
}

Json trials_schema() { return with_run(schema_of<TrialsFile>()); }

Table trials_table(const Trials& trials, bool by_query) {
  Table table;
  table.columns = {"frames recognized", "correct", "incorrect",
                   "pairs incorrect",   "first",   "ms/frame"};
  for (size_t t = 0; t < trials.all.size(); ++t) {
    const Trial& trial = trials.all[t];
    const FrameCounts total = trial.total();
    add_counts(table, trial.name + (trials.chosen == t ? " *" : ""), total, trial.seconds);
    if (!by_query || trial.counts.size() < 2) continue;
    for (size_t q = 0; q < trial.counts.size(); ++q) {
      const FrameCounts& counts = trial.counts[q];
      add_counts(table, "  " + trials.queries[q].name, counts,
                 trial.seconds * static_cast<double>(counts.path.frames) /
                     static_cast<double>(total.path.frames));
    }
  }
  return table;
}

std::string choice_text(const Trials& trials, const std::string& advice) {
  if (trials.chosen) {
    const Trial& trial = trials.all[*trials.chosen];
    const bool has_places = std::holds_alternative<FabmapQuerySettings>(trial.settings);
    const std::string counts = frame_counts_text(trial.total(), has_places);
    return wrapped_text(fmt::format("Choice: {}: {}.", trial.name, counts), 2) +
           (trial.is_tuned
                ? "Its threshold fits these frames; another recording may need another setting.\n"
                : "Another recording may need another setting.\n");
  }
  const bool any_correct = std::ranges::any_of(
      trials.all, [](const Trial& trial) { return trial.total().path.correct > 0; });
  if (any_correct)
    return fmt::format(
        "No choice: each setting with a correct frame has more than {} (--max-incorrect).\n",
        counted(trials.max_incorrect, "incorrect one"));
  if (!advice.empty())
    return "No choice: no setting recognizes a frame correctly.\n" + wrapped_text(advice, 2);
  return "No choice: no setting recognizes a frame correctly. Check the ground truth.\n";
}

}  // namespace vpr
