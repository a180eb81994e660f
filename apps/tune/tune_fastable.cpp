// vpr-tune fastable: c_l and t_r.
#include "base/stopwatch.h"
#include "run/advice.h"
#include "run/fuse.h"
#include "run/margin_plan.h"
#include "run/score_basis.h"
#include "run/train.h"
#include "sequence/sequence.h"
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
  const Sources sources = find_sources(inputs, DatabaseFamily::sequences, monitor);
  SequenceDatabase database = read_sequence_database(inputs.database);
  if (score_kind(settings->score).needs_statistics) ensure_statistics(database, monitor);
  fuse_views(database, *settings, inputs.fuse);
  const QueryResources resources{session.kernels, command.memory_limit, 0, session.options.seed};
  session.run.memory_limit = command.memory_limit;
  const Stopwatch watch;
  const auto sweep = [&](const Source& source, const Grid* grid, const TruthReader& reader) {
    const DescriptorSet query =
        replayed(describe_frames(open_sequence(source.sequence.sequence), database,
                                 settings->skip_unreadable, monitor),
                 inputs.warp, session.options.seed);
    warn_of_rates(database, query.frames.fps, *settings, monitor);
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
      "--score standardized --decide margin --margin 0.2:1:0.1",
      [&tune](Session& session) { tune_fastable(session, tune); });
  program.add_config(command, tune.settings);
  add_tune_inputs(command, tune.inputs);
  command.add_option("--c-l", tune.inputs.grid.windows, window_length_help());
  command.add_option("--t-r", tune.inputs.grid.thresholds, distance_threshold_help());
  add_setting(command, "--decide", tune.settings.decision,
              "what is a hit: threshold (default), or margin, which is swept instead of t_r");
  command.add_option("--margin", tune.inputs.grid.margins, margin_help());
  add_setting(command, "--margin-width", tune.settings.margin_width,
              "elsewhere is more than so many frames before or behind the best match (default: "
              "after how many a training sequence shows another place)");
  command.add_list("--same-place", tune.settings.same_place,
                   "A=B: these training sequences show the same place; repeatable; none: all "
                   "differ (default: as found)");
  add_setting(command, "--score", tune.settings.score,
              "raw (default), standardized or standardized-offline");
  command.add_option("--fuse", tune.inputs.fuse,
                     "FAB-MAP's database of the same training sequences, as vpr-query takes it");
  add_setting(command, "--fuse-beta", tune.settings.fusion_weight,
              "deviations a nat of what it says (default 0.2)");
  add_setting(command, "--t-r-scale", tune.settings.threshold_scale,
              "scale of the numbers: relative or bits, of standardized scores mean-z "
              "(default: relative, mean-z)");
  command
      .add_list("--rates", tune.settings.rates,
                "windows of these rates, as vpr-query takes them (default 1)")
      .comma_separated()
      .type_name("P/Q");
  command.add_flag("--skip-unreadable", tune.settings.skip_unreadable,
                   "frames that can't be decoded keep their index and never match");
  add_memory_flag(command, tune.memory_limit, "for rings and hits of all c_l, as in 512M");
}

}  // namespace vpr
