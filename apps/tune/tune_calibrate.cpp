// vpr-tune calibrate and vpr-tune threshold.
#include <fmt/format.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "present/database_report.h"
#include "run/open.h"
#include "run/thresholds.h"
#include "run/train_sequences.h"
#include "store/archive.h"
#include "tune.h"
#include "tune/calibration.h"

namespace vpr {
namespace {

constexpr const char* kLengths = "10,20,40";

/// vpr-tune calibrate, by default for margins of z-scores.
struct Calibrate {
  TuneOptions options;
  SequenceQuerySettings settings;
  double precision = 1;

  Calibrate() {
    settings.score = Score::zscore;
    settings.decision = Decision::margin;
  }
};

void calibrate(Session& session, const Calibrate& command) {
  TuneOptions options = command.options;
  options.selection.fallback_fps = options.selection.fps;
  const Monitor& monitor = session.monitor;
  session.claim_output();
  const std::vector<Source> sources = find_queries(options, DatabaseFamily::sequences, session);
  if (sources.size() > 1)
    throw Error(ErrorKind::usage, "a calibration is of one sequence; pass one --dataset");
  const Source& source = sources.front();
  const Stopwatch watch;
  const ResolvedSettings settings(command.settings, {Feature::database, Feature::calibrate});
  const SequenceDatabase database = open_database(options.database, settings, monitor);
  const QueryResources resources{options.memory_limit, 0, session.options.process.seed};
  const DescriptorSet query = describe_query(source.sequence.sequence, database, settings, monitor);
  CalibratedSequence result = calibrate_sequence(
      database, query, source.sequence.name, settings,
      window_lengths(options.grid.windows, kLengths, database, query), command.precision,
      reader_of(evaluation_of(source, &database), monitor), resources, monitor);
  result.fps = source.sequence.sequence.sequence.fps;
  session.run.memory_limit = options.memory_limit;
  session.run.paths = {{"database", options.database}};
  const Json json = calibration_json(result, session.run, watch.elapsed_s());
  session.write_output(json);
  session.print_result(
      render_table(calibration_table(result), options.format) + "\n" + calibration_text(result),
      json);
}

/// vpr-tune threshold.
struct Threshold {
  std::string database;
  std::string windows = "40";
  double safety_factor = 1;
  bool write = false;
  TableFormat format = TableFormat::text;
};

VPR_FIELDS(Threshold, safety_factor)

// Replaces the thresholds of the database for the same window lengths.
void store_thresholds(const Session& session, const std::string& path, SequenceDatabase& database,
                      const std::vector<ThresholdTable>& all) {
  for (const ThresholdTable& one : all) {
    std::erase_if(database.thresholds, [&](const ThresholdTable& stored) {
      return stored.window_length == one.window_length;
    });
    database.thresholds.push_back(one);
  }
  write_sequence_database(path, database, session.outputs);
}

void compute_thresholds(Session& session, const Threshold& command) {
  check_safety_factor(command.safety_factor);
  session.claim_output();
  if (command.write) {
    session.outputs.extend(command.database);
    session.outputs.claim_folder(command.database, is_database_folder);
  }
  SequenceDatabase database = read_sequence_database(command.database);
  check_automatic(database, {});
  std::vector<ThresholdTable> all;
  for (const uint64_t length : parse_counts(command.windows, "--c-l")) {
    check_window_length(length);
    check_sums(database.descriptors, length);
    const std::vector<DescribedFrames> spans = code_spans(database);
    all.push_back(compute_thresholds(spans, length, command.safety_factor, session.monitor));
    if (const auto sentence = overlap_warning(all.back(), database.sequences, spans))
      warn(session.monitor, *sentence);
  }
  if (command.write) store_thresholds(session, command.database, database, all);
  const Json json = thresholds_json(database.sequences, all, command.safety_factor, session.run);
  session.write_output(json);
  session.print_result(render_table(thresholds_table(database.sequences, all, command.safety_factor,
                                                     command.database),
                                    command.format),
                       json);
}

}  // namespace

void add_calibrate(Program& program) {
  const auto tune = std::make_shared<Calibrate>();
  TuneOptions& options = tune->options;
  const Command command = program.add_command(
      "calibrate",
      "Choose a margin for other sequences. The result is a file for vpr-query --config.",
      "  vpr-tune calibrate corridor.vprdb --query tuesday --ground-truth pairs.csv -o "
      "calibrated.json\n"
      "  vpr-query corridor.vprdb --query wednesday --config calibrated.json -o result.json\n"
      "  vpr-tune calibrate corridor.vprdb --query tuesday --ground-truth pairs.csv --method "
      "filter "
      "--target-precision 0.99",
      [tune](Session& session) { calibrate(session, *tune); });
  program.add_config(command, tune->settings);
  add_query_flags(command, options,
                  "; a query of unknown rate has this rate, so that false recognitions are "
                  "reported per hour instead of per 1000 windows")
      .required();
  add_setting(command, "--target-precision", tune->precision,
              "least share of correct windows among recognized ones (default: 1)");
  command.add_option("--c-l", options.grid.windows,
                     fmt::format("window lengths, as in 10,20; chosen is the shortest with nearly "
                                 "the highest recall (default: those of {} that fit)",
                                 kLengths));
  add_setting(command, "--method", tune->settings.method,
              "exact matching method of vpr-query, such as fastable or filter (default: fastable)");
  add_settings(command, tune->settings, sequence_setting_rows(), Feature::calibrate);
  add_memory_flag(command, options.memory_limit);
  add_format_flag(command, options.format);
}

void add_threshold(Program& program) {
  const auto tune = std::make_shared<Threshold>();
  const Command command = program.add_command(
      "threshold", "List automatic thresholds t_r. The list has the frames that set them.",
      "  vpr-tune threshold building.vprdb --c-l 20,40\n"
      "  vpr-tune threshold building.vprdb --c-l 60 --safety-factor 0.9 --write",
      [tune](Session& session) { compute_thresholds(session, *tune); });
  program.add_config(command, *tune);
  command.add_option("DB", tune->database, "database of a sequence method").required();
  command.add_option("--c-l", tune->windows, "window lengths, as in 20,40 (default: 40)");
  add_setting(command, "--safety-factor", tune->safety_factor, "factor of t_r (default: 1)");
  command.add_flag("--write", tune->write, "store the thresholds in the database");
  add_format_flag(command, tune->format);
}

}  // namespace vpr
