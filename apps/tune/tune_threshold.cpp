// vpr-tune threshold: the automatic t_r, and why it is what it is.
#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "number_lists.h"
#include "present/database_report.h"
#include "run/thresholds.h"
#include "run/train.h"
#include "store/archive.h"
#include "tune_inputs.h"

namespace vpr {
namespace {

void check_command(const Session& session, const ThresholdTune& command) {
  check_safety_factor(command.safety_factor);
  session.claim_output();
  if (!command.write) return;
  session.outputs.extend(command.database);
  session.outputs.claim_folder(command.database, is_database_folder);
}

// In place of those that it has for the same window lengths.
void keep_thresholds(const Session& session, const std::string& path, SequenceDatabase& database,
                     const std::vector<AutomaticThresholds>& all) {
  for (const AutomaticThresholds& one : all) {
    std::erase_if(database.thresholds, [&](const ThresholdTable& stored) {
      return stored.window_length == one.table.window_length;
    });
    database.thresholds.push_back(one.table);
  }
  write_sequence_database(path, database, session.outputs);
}

void tune_threshold(Session& session, const ThresholdTune& command) {
  check_command(session, command);
  SequenceDatabase database = read_sequence_database(command.database);
  check_automatic(database, {});
  std::vector<AutomaticThresholds> all;
  for (const uint64_t length : parse_counts(command.windows, "--c-l")) {
    check_window_length(length);
    ThresholdTable table =
        compute_thresholds(descriptor_spans(database), length, command.safety_factor,
                           session.kernels, session.monitor);
    warn_of_overlaps(database, table, session.monitor);
    all.push_back(automatic_thresholds(database, std::move(table), session.monitor));
  }
  if (command.write) keep_thresholds(session, command.database, database, all);
  const Json json = thresholds_json(database.sequences, all, command.safety_factor, session.run);
  session.write_output(json);
  session.print_result(render_table(thresholds_table(database.sequences, all, command.safety_factor,
                                                     command.database),
                                    command.format),
                       json);
}

}  // namespace

void add_threshold(Program& program, ThresholdTune& tune) {
  const Command command = program.add_command(
      "threshold", "The automatic t_r of every training sequence, and where it comes from.",
      "  vpr-tune threshold building.vprdb --c-l 20,40,60,80\n"
      "  vpr-tune threshold building.vprdb --c-l 60 --safety-factor 0.9 --write",
      [&tune](Session& session) { tune_threshold(session, tune); });
  program.add_config(command, tune);
  command.add_option("DB", tune.database, "database of sequences").required();
  command.add_option("--c-l", tune.windows, "window lengths, as in 20,40 (default 40)");
  add_setting(command, "--safety-factor", tune.safety_factor, "multiplies t_r (default 1)");
  command.add_flag("--write", tune.write, "keep them in the database");
  add_setting(command, "--format", tune.format,
              "of the table: text (default), csv, markdown or latex");
}

}  // namespace vpr
