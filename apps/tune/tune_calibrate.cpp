// vpr-tune calibrate: a margin from a labeled walk, for walks without labels.
#include <fmt/format.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "common/selection_flags.h"
#include "present/calibration_report.h"
#include "run/calibrate.h"
#include "run/train.h"
#include "tune_inputs.h"

namespace vpr {
namespace {

CalibratedWalk calibrate(Session& session, const CalibrateTune& command, const Source& source,
                         double precision) {
  const Monitor& monitor = session.monitor;
  const ResolvedSettings settings(command.settings, {kDatabaseChoice, kCalibrateChoice});
  const SequenceDatabase database = open_database(command.inputs.database, settings, "", monitor);
  const QueryResources resources{session.kernels, command.memory_limit, 0, session.options.seed};
  const DescriptorSet query = describe_query(source.sequence.sequence, database, settings, monitor);
  return calibrate_walk(database, query, source.sequence.name, settings,
                        calibrated_lengths(command.windows, database, query), precision,
                        reader_of(source, &database, monitor), resources, monitor);
}

void tune_calibrate(Session& session, const CalibrateTune& command) {
  TuneInputs inputs = command.inputs;
  inputs.selection.otherwise =
      inputs.selection.fps;  // a walk that does not say its rate has this one
  session.claim_output();
  const Sources sources = find_sources(inputs, DatabaseFamily::sequences, session);
  if (sources.queries.size() > 1)
    throw Error(ErrorKind::usage, "a calibration is of one walk; give one --dataset");
  const CalibrationRequest request{command.precision.value_or(1),
                                   sources.queries.front().sequence.sequence.sequence.fps};
  const Stopwatch watch;
  const CalibratedWalk walk =
      calibrate(session, command, sources.queries.front(), request.precision);
  if (!walk.chosen)
    throw Error(ErrorKind::expectation,
                fmt::format("{}: no margin: {}", walk.query.name, calibration_failure(walk)));
  session.run.simd_target = session.kernels.target;
  session.run.memory_limit = command.memory_limit;
  session.run.paths = {{"database", command.inputs.database}};
  const Json json = calibration_json(walk, request, session.run, watch.elapsed_s());
  session.write_output(json);
  session.print_result(render_table(calibration_table(walk), command.inputs.format) + "\n" +
                           calibration_text(walk, request),
                       json);
}

void add_walk(const Command& command, TuneInputs& inputs) {
  command.add_option("DB", inputs.database, "database of sequences").required();
  command.add_option("--query", inputs.query, "a walk, or with --dataset the name of one");
  command.add_option("--ground-truth", inputs.ground_truth, ground_truth_help());
  command.add_list("--dataset", inputs.datasets,
                   "data set description with the walk and its ground truth");
  add_warp_flag(command, inputs.selection.warp);
  add_rate_flags(command, inputs.selection,
                 "a walk whose rate is known (any other has it: false recognitions are given for "
                 "an hour, and not for 1000 windows)");
  add_ground_truth_flags(command, inputs.flags);
}

void add_asked(const Command& command, CalibrateTune& tune) {
  command.add_option("--precision", tune.precision,
                     "share of the recognized windows that is to be right (default 1)");
  command.add_option("--c-l", tune.windows, calibrated_lengths_help());
}

}  // namespace

CalibrateTune::CalibrateTune() {
  settings.score = Score::zscore;
  settings.decision = Decision::margin;
}

void add_calibrate(Program& program, CalibrateTune& tune) {
  const Command command = program.add_command(
      "calibrate", "A margin from a short labeled walk, for vpr-query --config on others.",
      "  vpr-tune calibrate corridor.vprdb --query corridor/query --ground-truth aligned "
      "--tolerance 3 --fps 2 -o calibrated.json\n"
      "  vpr-query corridor.vprdb --query another/walk --config calibrated.json -o result.json\n"
      "  vpr-tune calibrate corridor.vprdb --query corridor/query --ground-truth pairs.csv "
      "--method filter --precision 0.99",
      [&tune](Session& session) { tune_calibrate(session, tune); });
  program.add_config(command, tune.settings);
  add_walk(command, tune.inputs);
  add_asked(command, tune);
  add_setting(command, "--method", tune.settings.method,
              "fastable (default), filter, or another exact one of vpr-query");
  add_score_settings(command, tune.settings);
  add_unreadable_flag(command, tune.settings.skip_unreadable);
  add_memory_flag(command, tune.memory_limit, "for rings and recognitions, as in 512M");
  add_setting(command, "--format", tune.inputs.format,
              "of the table: text (default), csv, markdown or latex");
}

}  // namespace vpr
