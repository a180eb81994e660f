// vpr-tune fabmap: c_w and t_p.
#include "base/json.h"
#include "images/sequence.h"
#include "tune_grids.h"
#include "tune_sweep.h"

namespace vpr {
namespace {

struct FabmapTuner {
  static constexpr const char* kMethod = "fabmap";

  Session& session;
  const FabmapTune& command;
  FabmapDatabase database;

  SequenceWords describe(const Source& source) const {
    return describe_words(open_sequence(source.sequence.sequence), database,
                          command.settings.skip_unreadable, session.monitor);
  }
  const ScoreKind& score() const { return probability_kind(); }
  Grid grid(const SequenceWords&) const { return fabmap_grid(command.inputs.grid); }
  std::vector<CellCounts> sweep(const SequenceWords& query, const std::string& name,
                                const Grid& grid, const TruthReader& reader) const {
    return sweep_fabmap(database, query, name, command.settings, grid, reader, session.options.seed,
                        session.monitor);
  }
  FabmapQuerySettings settings_of(const CellCounts& cell) const {
    FabmapQuerySettings settings = command.settings;
    settings.window = cell.window;
    settings.place_threshold = *cell.threshold;
    return settings;
  }
  Result query(const SequenceWords& query, const CellCounts& cell) const {
    return query_fabmap(database, query, "", settings_of(cell), session.options.seed, {},
                        session.monitor)
        .result;
  }
};

void tune_fabmap(Session& session, const FabmapTune& command) {
  const TuneInputs& inputs = command.inputs;
  claim_outputs(inputs, session);
  const std::vector<Source> sources = find_sources(inputs, true);
  const auto validation = find_validation(inputs, sources, true, session.monitor);
  const FabmapTuner tuner{session, command, read_fabmap_database(inputs.database)};
  Json settings = value_to_json(command.settings);
  for (const char* key : {"c_w", "t_p"}) settings.erase(key);
  tune(session, inputs, tuner, sources, validation, settings);
}

}  // namespace

void add_fabmap(Program& program, FabmapTune& tune) {
  const Command command = program.add_command(
      "fabmap", "All windows and thresholds of FAB-MAP from one pass of posteriors.",
      "  vpr-tune fabmap places.vprdb --query walk --ground-truth places.csv --c-w 1,3,5,8 "
      "--t-p 0.6,0.9,0.99 --save-config best.json -o sweep.json",
      [&tune](Session& session) { tune_fabmap(session, tune); });
  program.add_config(command, tune.settings);
  add_tune_inputs(command, tune.inputs);
  command.add_option("--c-w", tune.inputs.grid.windows, fabmap_window_help());
  command.add_option("--t-p", tune.inputs.grid.thresholds, place_threshold_help());
  command.add_flag("--skip-unreadable", tune.settings.skip_unreadable,
                   "frames that can't be decoded keep their index and show no words");
}

}  // namespace vpr
