// vpr-tune fastable: c_l and t_r.
#include <algorithm>

#include "base/json.h"
#include "images/sequence.h"
#include "pipeline/score_basis.h"
#include "pipeline/train.h"
#include "tune_grids.h"
#include "tune_sweep.h"

namespace vpr {
namespace {

struct FastableTuner {
  static constexpr const char* kMethod = "fastable";

  Session& session;
  const FastableTune& command;
  SequenceDatabase database;
  QueryResources resources;

  DescriptorSet describe(const Source& source) const {
    return database.descriptors.kind->describe(
        open_sequence(source.sequence.sequence), database.descriptor,
        command.settings.skip_unreadable ? Unreadable::skip : Unreadable::fail, session.monitor);
  }
  const ScoreKind& score() const { return score_kind(command.settings.score); }
  Grid grid(const DescriptorSet& query) const {
    return sequence_grid(command.inputs.grid, command.settings, database, query);
  }
  std::vector<CellCounts> sweep(const DescriptorSet& query, const std::string& name,
                                const Grid& grid, const TruthReader& reader) const {
    std::vector<CellCounts> cells = sweep_sequences(database, query, name, command.settings, grid,
                                                    reader, resources, session.monitor);
    explain_automatic(cells);
    return cells;
  }
  // Of several windows whose automatic threshold gives no hits, the longest tells most.
  void explain_automatic(const std::vector<CellCounts>& cells) const {
    uint64_t longest = 0;
    for (const CellCounts& cell : cells) {
      const LabelCounts& hits = cell.counts.hits;
      if (!cell.threshold && hits.correct + hits.incorrect + hits.ignored == 0)
        longest = std::max(longest, cell.window);
    }
    if (longest > 0) explain_no_hits(database, longest, session.kernels, session.monitor);
  }
  SequenceQuerySettings settings_of(const CellCounts& cell) const {
    SequenceQuerySettings settings = command.settings;
    settings.window_length = cell.window;
    settings.distance_threshold = cell.threshold;
    return settings;
  }
  Result query(const DescriptorSet& query, const CellCounts& cell) const {
    Monitor quiet = session.monitor;  // the sweep has said what there is to say
    quiet.warn = nullptr;
    return run_query(plan_query(database, query, "", settings_of(cell), resources, quiet), database,
                     query, resources, {}, quiet)
        .result;
  }
};

void tune_fastable(Session& session, const FastableTune& command) {
  const TuneInputs& inputs = command.inputs;
  claim_outputs(inputs, session);
  const std::vector<Source> sources = find_sources(inputs, false);
  const auto validation = find_validation(inputs, sources, false, session.monitor);
  FastableTuner tuner{session, command, read_sequence_database(inputs.database), {}};
  if (score_kind(command.settings.score).needs_statistics)
    ensure_statistics(tuner.database, session.monitor);
  tuner.resources.kernels = session.kernels;
  tuner.resources.seed = session.options.seed;
  tuner.resources.memory_limit = session.run.memory_limit = command.memory_limit;
  Json settings = settings_in_force(command.settings);
  for (const char* key : {"c_l", "t_r"}) settings.erase(key);
  tune(session, inputs, tuner, sources, validation, settings);
}

}  // namespace

void add_fastable(Program& program, FastableTune& tune) {
  const Command command = program.add_command(
      "fastable", "All window lengths and thresholds of FastABLE in one pass.",
      "  vpr-tune fastable corridor.vprdb --query corridor/query --ground-truth pairs.csv\n"
      "  vpr-tune fastable corridor.vprdb --query corridor/query --ground-truth pairs.csv "
      "--c-l 2,5,10,20,40 --t-r 0.2:0.7:0.05 --save-config best.json -o sweep.json",
      [&tune](Session& session) { tune_fastable(session, tune); });
  program.add_config(command, tune.settings);
  add_tune_inputs(command, tune.inputs);
  command.add_option("--c-l", tune.inputs.grid.windows, window_length_help());
  command.add_option("--t-r", tune.inputs.grid.thresholds, distance_threshold_help());
  add_setting(command, "--score", tune.settings.score,
              "raw (default), standardized or standardized-offline");
  add_setting(command, "--t-r-scale", tune.settings.threshold_scale,
              "of the numbers: relative (default), mean or bits, as vpr-query takes them; of "
              "standardized scores mean-z");
  add_setting(command, "--safety-margin", tune.settings.safety_margin,
              "taken from the automatic t_r of standardized scores (default 0)");
  command.add_flag("--skip-unreadable", tune.settings.skip_unreadable,
                   "frames that can't be decoded keep their index and never match");
  add_memory_flag(command, tune.memory_limit, "for rings and hits of all c_l, as in 512M");
}

}  // namespace vpr
