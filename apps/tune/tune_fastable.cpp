// vpr-tune fastable: c_l and t_r.
#include "base/stopwatch.h"
#include "run/advice.h"
#include "run/plan.h"
#include "run/train.h"
#include "tune_inputs.h"

namespace vpr {
namespace {

void tune_fastable(Session& session, const FastableTune& command) {
  const TuneInputs& inputs = command.inputs;
  RunChoices run = {kDatabaseChoice, kSweepChoice};
  if (!inputs.fuse.empty()) run.emplace_back("--fuse");
  if (!inputs.grid.thresholds.empty()) run.emplace_back("--t-r");
  if (!inputs.grid.margins.empty()) run.emplace_back("--margin");
  const ResolvedSettings settings(command.settings, run);
  const Monitor& monitor = session.monitor;
  claim_outputs(inputs, session);
  const Sources sources = find_sources(inputs, DatabaseFamily::sequences, session);
  SequenceDatabase database = open_database(inputs.database, settings, inputs.fuse, monitor);
  const QueryResources resources{session.kernels, command.memory_limit, 0, session.options.seed};
  session.run.memory_limit = command.memory_limit;
  const Stopwatch watch;
  const auto sweep = [&](const Source& source, const Grid* grid, const TruthReader& reader) {
    const DescriptorSet query =
        describe_query(source.sequence.sequence, database, settings, monitor);
    Sweep found = sweep_sequences(
        database, query, source.sequence.name, settings,
        grid != nullptr ? *grid : sequence_grid(inputs.grid, *settings, database, query), reader,
        resources, monitor);
    if (!found.recommendation.cell) {
      ensure_statistics(database, monitor);
      warn(monitor, filter_finding(database, query, *settings, resources, monitor));
    }
    return found;
  };
  const std::vector<Sweep> sweeps = sweep_all(sources, &database, sweep, monitor);
  present(session, inputs, DatabaseFamily::sequences, *settings, sweeps, watch.elapsed_s());
}

}  // namespace

void add_fastable(Program& program, FastableTune& tune) {
  const Command command = program.add_command(
      "fastable", "All window lengths and thresholds of FastABLE in one pass.",
      "  vpr-tune fastable corridor.vprdb --query corridor/query --ground-truth pairs.csv\n"
      "  vpr-tune fastable corridor.vprdb --query corridor/query --ground-truth pairs.csv "
      "--c-l 2,5,10,20,40 --t-r 0.2:0.7:0.05 --save-config best.json -o sweep.json\n"
      "  vpr-tune fastable corridor.vprdb --query corridor/query --ground-truth pairs.csv "
      "--score zscore --decide margin --margin 0.2:1:0.1",
      [&tune](Session& session) { tune_fastable(session, tune); });
  program.add_config(command, tune.settings);
  add_tune_inputs(command, tune.inputs);
  command.add_option("--c-l", tune.inputs.grid.windows, window_length_help());
  command.add_option("--t-r", tune.inputs.grid.thresholds, distance_threshold_help());
  command.add_option("--margin", tune.inputs.grid.margins, margin_help());
  add_score_settings(command, tune.settings);
  add_decision_settings(command, tune.settings, tune.inputs.fuse);
  add_unreadable_flag(command, tune.settings.skip_unreadable);
  add_memory_flag(command, tune.memory_limit, "for rings and recognitions of all c_l, as in 512M");
}

}  // namespace vpr
