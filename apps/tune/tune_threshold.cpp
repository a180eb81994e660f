// vpr-tune threshold: the automatic thresholds of a database.
#include "database/archive.h"
#include "present/database_report.h"
#include "query/prepare.h"
#include "query/thresholds.h"
#include "query/train_sequences.h"
#include "tune.h"

namespace vpr {
namespace {

/// vpr-tune threshold.
struct ThresholdCommand {
  std::string database;
  std::string windows = "40";
  double safety_factor = 1;
  bool write = false;
  TableFormat format = TableFormat::text;
};

VPR_FIELDS(ThresholdCommand, (safety_factor))

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

void compute_thresholds(Session& session, const ThresholdCommand& command) {
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

void add_threshold(Program& program) {
  const auto tune = std::make_shared<ThresholdCommand>();
  const Command command = program.add_command(
      "threshold", "List automatic thresholds t_r. The list has the frames that set them.",
      "  vpr-tune threshold extended.vprdb --c-l 20,40\n"
      "  vpr-tune threshold extended.vprdb --c-l 60 --safety-factor 0.9 --write",
      [tune](Session& session) { compute_thresholds(session, *tune); });
  program.add_config(command, *tune);
  command.add_option("DB", tune->database, "database of a sequence method").required();
  command.add_option("--c-l", tune->windows, "window lengths, as in 20,40 (default: 40)");
  add_setting(command, "--safety-factor", tune->safety_factor, "factor of t_r (default: 1)");
  command.add_flag("--write", tune->write, "store the thresholds in the database");
  add_format_flag(command, tune->format);
}

}  // namespace vpr
