// vpr-tune: which window, which threshold? Whole grids for little more than one query.
#include <fmt/format.h>

#include "base/json.h"
#include "base/stopwatch.h"
#include "number_lists.h"
#include "pipeline/score_basis.h"
#include "pipeline/train.h"
#include "tune_inputs.h"

namespace vpr {
namespace {

/// What vpr-tune fastable sets beside the grid.
struct FastableTune {
  TuneInputs inputs;
  SequenceQuerySettings settings;
};

SequenceGrid sequence_grid(const TuneInputs& inputs) {
  SequenceGrid grid;
  grid.window_lengths = parse_counts(inputs.windows, "--c-l");
  std::string numbers = inputs.thresholds;
  const size_t automatic = numbers.find("auto");
  const bool has_auto = automatic != std::string::npos;
  if (has_auto) {
    const size_t comma = automatic > 0 ? automatic - 1 : automatic;
    numbers.erase(comma, automatic + 4 - comma + (automatic == 0 && numbers.size() > 4 ? 1 : 0));
  }
  if (!numbers.empty())
    for (const double number : parse_numbers(numbers, "--t-r"))
      grid.distance_thresholds.emplace_back(number);
  if (has_auto) grid.distance_thresholds.emplace_back(std::nullopt);
  return grid;
}

// What stays the same for all cells.
Json settings_json(Json json, const std::vector<const char*>& of_the_grid) {
  for (const char* key : of_the_grid) json.erase(key);
  return json;
}

SequenceQuerySettings settings_of(const SequenceQuerySettings& base,
                                  const SequenceCellCounts& cell) {
  SequenceQuerySettings settings = base;
  settings.window_length = cell.window_length;
  settings.distance_threshold = cell.distance_threshold;
  return settings;
}

// A sweep of one cell, as JSON.
Json single_cell_json(const std::string& query, std::vector<SequenceCellCounts> sequence_cells,
                      std::vector<FabmapCellCounts> fabmap_cells) {
  Sweep sweep;
  sweep.query_name = query;
  sweep.sequence_cells = std::move(sequence_cells);
  sweep.fabmap_cells = std::move(fabmap_cells);
  Json json;
  add_sweeps(json, {sweep});
  return json["cells"][0];
}

void tune_fastable(Session& session, const FastableTune& command) {
  const TuneInputs& inputs = command.inputs;
  check_outputs(inputs, session.options);
  const Stopwatch watch;
  const SequenceGrid grid = sequence_grid(inputs);
  const std::vector<Source> sources = find_sources(inputs, false);
  const auto validation = find_validation(inputs, sources, session.monitor);
  SequenceDatabase database = read_sequence_database(inputs.database);
  if (command.settings.score != Score::raw)
    ensure_statistics(database, session.kernels, session.monitor);
  QueryResources resources;
  resources.kernels = session.kernels;
  resources.seed = session.options.seed;
  const auto describe = [&](const Source& source) {
    return describe_sequence(open_sequence(source.sequence.sequence), database.descriptor,
                             command.settings.skip_unreadable ? Unreadable::skip : Unreadable::fail,
                             session.monitor);
  };
  const auto validate = [&](const SequenceCellCounts& chosen) {
    std::string protocol;
    const std::string& name = validation->sequence.name;
    return single_cell_json(
        name,
        sweep_sequences(database, describe(*validation), name, command.settings,
                        {{chosen.window_length}, {chosen.distance_threshold}},
                        reader_of(validation->ground_truth, protocol), resources, session.monitor),
        {});
  };
  const Json settings = settings_json(settings_in_force(command.settings), {"c_l", "t_r"});
  PartialSweeps partial(inputs, session.options,
                        sweep_key(inputs, settings, database.fingerprint, resources.seed));
  for (size_t s = partial.finished().size(); s < sources.size(); ++s) {
    Sweep sweep;
    sweep.query_name = sources[s].sequence.name;
    const SequenceCodes query = describe(sources[s]);
    const TruthReader reader = reader_of(sources[s].ground_truth, sweep.protocol);
    sweep.sequence_cells = sweep_sequences(database, query, sweep.query_name, command.settings,
                                           grid, reader, resources, session.monitor);
    sweep.recommendation = recommend_cell(sweep.sequence_cells);
    if (sweep.recommendation.cell) {
      const SequenceCellCounts& chosen = sweep.sequence_cells[*sweep.recommendation.cell];
      sweep.intervals = sequence_intervals(database, query, settings_of(command.settings, chosen),
                                           reader, resources, session.monitor);
      if (validation) sweep.validation = validate(chosen);
    }
    partial.add(sweep);
  }
  present(session, inputs, partial.finished(), "fastable", settings, watch.elapsed_s());
  partial.remove();
}

struct FabmapTune {
  TuneInputs inputs;
  FabmapQuerySettings settings;
};

void tune_fabmap(Session& session, const FabmapTune& command) {
  const TuneInputs& inputs = command.inputs;
  check_outputs(inputs, session.options);
  const Stopwatch watch;
  const FabmapGrid grid{parse_counts(inputs.windows, "--c-w"),
                        parse_numbers(inputs.thresholds, "--t-p")};
  const std::vector<Source> sources = find_sources(inputs, true);
  const auto validation = find_validation(inputs, sources, session.monitor);
  const FabmapDatabase database = read_fabmap_database(inputs.database);
  const uint64_t seed = session.options.seed;
  const auto describe = [&](const Source& source) {
    return describe_words(open_sequence(source.sequence.sequence), database,
                          command.settings.skip_unreadable, session.monitor);
  };
  const auto validate = [&](const FabmapCellCounts& chosen) {
    std::string protocol;
    const std::string& name = validation->sequence.name;
    return single_cell_json(
        name, {},
        sweep_fabmap(database, describe(*validation), name, command.settings,
                     {{chosen.window}, {chosen.place_threshold}},
                     reader_of(validation->ground_truth, protocol), seed, session.monitor));
  };
  const Json settings = settings_json(value_to_json(command.settings), {"c_w", "t_p"});
  PartialSweeps partial(inputs, session.options,
                        sweep_key(inputs, settings, database.fingerprint, seed));
  for (size_t s = partial.finished().size(); s < sources.size(); ++s) {
    Sweep sweep;
    sweep.query_name = sources[s].sequence.name;
    const SequenceWords query = describe(sources[s]);
    const TruthReader reader = reader_of(sources[s].ground_truth, sweep.protocol);
    sweep.fabmap_cells = sweep_fabmap(database, query, sweep.query_name, command.settings, grid,
                                      reader, seed, session.monitor);
    sweep.recommendation = recommend_cell(sweep.fabmap_cells);
    if (sweep.recommendation.cell) {
      const FabmapCellCounts& chosen = sweep.fabmap_cells[*sweep.recommendation.cell];
      FabmapQuerySettings chosen_settings = command.settings;
      chosen_settings.window = chosen.window;
      chosen_settings.place_threshold = chosen.place_threshold;
      sweep.intervals =
          fabmap_intervals(database, query, chosen_settings, reader, seed, session.monitor);
      if (validation) sweep.validation = validate(chosen);
    }
    partial.add(sweep);
  }
  present(session, inputs, partial.finished(), "fabmap", settings, watch.elapsed_s());
  partial.remove();
}

void add_fastable(Program& program, FastableTune& tune) {
  const Command command = program.add_command(
      "fastable", "All window lengths and thresholds of FastABLE in one pass.",
      "  vpr-tune fastable corridor.vprdb --query corridor/query --ground-truth pairs.csv "
      "--c-l 2,5,10,20,40 --t-r 0.2:0.7:0.05 -o sweep.json",
      [&tune](Session& session) { tune_fastable(session, tune); });
  program.add_config(command, tune.settings);
  add_tune_inputs(command, tune.inputs);
  command.add_option("--c-l", tune.inputs.windows, "window lengths, as in 2,5,10 or 10:50:10")
      .required();
  command
      .add_option("--t-r", tune.inputs.thresholds,
                  "thresholds, as in 0.2:0.6:0.05; the word auto may be one of them")
      .required();
  add_setting(command, "--score", tune.settings.score,
              "raw (default), standardized or standardized-offline");
  add_setting(command, "--t-r-scale", tune.settings.threshold_scale,
              "of the numbers: relative (default) or bits; of standardized scores mean-z");
  add_setting(command, "--safety-margin", tune.settings.safety_margin,
              "taken from the automatic t_r of standardized scores (default 0)");
  command.add_flag("--skip-unreadable", tune.settings.skip_unreadable,
                   "frames that can't be decoded keep their index and never match");
}

void add_fabmap(Program& program, FabmapTune& tune) {
  const Command command = program.add_command(
      "fabmap", "All windows and thresholds of FAB-MAP from one pass of posteriors.",
      "  vpr-tune fabmap places.vprdb --query walk --ground-truth places.csv --c-w 1,3,5,8 "
      "--t-p 0.6,0.99 -o sweep.json",
      [&tune](Session& session) { tune_fabmap(session, tune); });
  program.add_config(command, tune.settings);
  add_tune_inputs(command, tune.inputs);
  command.add_option("--c-w", tune.inputs.windows, "windows, as in 1,3,5,8").required();
  command.add_option("--t-p", tune.inputs.thresholds, "thresholds, as in 0.5:0.95:0.05,0.99")
      .required();
  command.add_flag("--skip-unreadable", tune.settings.skip_unreadable,
                   "frames that can't be decoded keep their index and show no words");
}

}  // namespace
}  // namespace vpr

int main(int argc, char** argv) {
  using namespace vpr;
  Program program("vpr-tune", "Choose window lengths and thresholds: whole grids in one pass.",
                  "  vpr-tune fastable corridor.vprdb --query corridor/query --ground-truth "
                  "aligned --tolerance 3 --c-l 5,10,20 --t-r 0.3:0.7:0.1 -o sweep.json");
  FastableTune fastable;
  add_fastable(program, fastable);
  FabmapTune fabmap;
  add_fabmap(program, fabmap);
  ThresholdTune threshold;
  add_threshold(program, threshold);
  return program.main(argc, argv);
}
