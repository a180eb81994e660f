// vpr-tune fabmap: c_w and t_p.
#include "base/stopwatch.h"
#include "sequence/sequence_source.h"
#include "tune_inputs.h"

namespace vpr {
namespace {

void tune_fabmap(Session& session, const FabmapTune& command) {
  const TuneInputs& inputs = command.inputs;
  const Monitor& monitor = session.monitor;
  claim_outputs(inputs, session);
  const Sources sources = find_sources(inputs, DatabaseFamily::fabmap, session);
  const FabmapDatabase database = read_fabmap_database(inputs.database);
  const Stopwatch watch;
  const auto sweep = [&](const Source& source, const Grid* grid, const TruthReader& reader) {
    const SequenceWords query = describe_words(open_sequence(source.sequence.sequence), database,
                                               command.settings.skip_unreadable, monitor);
    return sweep_fabmap(database, query, source.sequence.name, command.settings,
                        grid != nullptr ? *grid : fabmap_grid(inputs.grid), reader,
                        session.options.seed, monitor);
  };
  const std::vector<Sweep> sweeps = sweep_all(sources, nullptr, sweep, monitor);
  present(session, inputs, DatabaseFamily::fabmap, command.settings, sweeps, watch.elapsed_s());
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
  add_unreadable_flag(command, tune.settings.skip_unreadable);
}

}  // namespace vpr
