// vpr-tune threshold: the automatic t_r, and why it is what it is.
#include <fmt/format.h>

#include "number_lists.h"
#include "pipeline/train.h"
#include "recognition/automatic_threshold.h"
#include "report/run_info.h"
#include "report/table.h"
#include "tune_inputs.h"

namespace vpr {
namespace {

std::string frame_span(const TrainSequence& sequence, size_t window, size_t length) {
  const std::string& first = sequence.frame_names[window];
  const std::string& last = sequence.frame_names[window + length - 1];
  return fmt::format("{}: {} to {}", sequence.name, first, last);
}

void tune_threshold(Session& session, const ThresholdTune& command) {
  check_safety_factor(command.safety_factor);
  if (!session.options.output.empty())
    check_output_file(session.options.output, session.options.existing());
  SequenceDatabase database = read_sequence_database(command.database);
  if (database.sequences.size() < 2)
    throw Error(ErrorKind::usage, fmt::format("{}: an automatic t_r needs at least two training "
                                              "sequences, and it holds one",
                                              command.database));
  Table table;
  table.title =
      fmt::format("{}: automatic t_r, safety factor {:g}", command.database, command.safety_factor);
  table.columns = {"sequence", "c_l", "t_r (bits)", "own frames", "closest other frames"};
  Json json = {{"schema", "vpr.thresholds/1"}, {"safety_factor", command.safety_factor}};
  json["thresholds"] = Json::array();
  for (const uint64_t length : parse_counts(command.windows, "--c-l")) {
    const ThresholdTable thresholds = compute_thresholds(database, length, command.safety_factor,
                                                         session.kernels, session.monitor);
    for (const std::string& sentence : overlap_warnings(thresholds, database.sequences))
      warn(session.monitor, sentence);
    for (size_t s = 0; s < database.sequences.size(); ++s) {
      const TrainSequence& own = database.sequences[s];
      const auto& closest = thresholds.closest[s];
      Json item = {{"sequence", own.name}, {"c_l", length}};
      if (!closest) {
        table.rows.push_back({own.name, std::to_string(length), "-", "-", "-"});
        item["t_r"] = nullptr;
      } else {
        const double t_r = automatic_threshold(*closest, length, command.safety_factor);
        const std::string mine = frame_span(own, closest->window, length);
        const std::string other =
            frame_span(database.sequences[closest->other_sequence], closest->other_window, length);
        table.rows.push_back(
            {own.name, std::to_string(length), fmt::format("{:.2f}", t_r), mine, other});
        item["t_r"] = t_r;
        item["distance"] = closest->distance;
        item["own_frames"] = mine;
        item["closest_frames"] = other;
      }
      json["thresholds"].push_back(item);
    }
    if (command.write) {
      std::erase_if(database.thresholds,
                    [&](const ThresholdTable& stored) { return stored.window_length == length; });
      database.thresholds.push_back(thresholds);
    }
  }
  if (command.write) write_sequence_database(command.database, database, Existing::replace);
  json["provenance"] = provenance_json(session.run);
  if (!session.options.output.empty())
    write_file(session.options.output, to_text(json), session.options.existing());
  session.print_result(render_table(table, command.format), json);
}

}  // namespace

void add_threshold(Program& program, ThresholdTune& tune) {
  CLI::App& command = program.add_command(
      "threshold", "The automatic t_r of every training sequence, and where it comes from.",
      "  vpr-tune threshold building.vprdb --c-l 20,40,60,80\n"
      "  vpr-tune threshold building.vprdb --c-l 60 --safety-factor 0.9 --write",
      [&tune](Session& session) { tune_threshold(session, tune); });
  program.add_config(command, tune);
  command.add_option("DB", tune.database, "database of sequences")->required();
  command.add_option("--c-l", tune.windows, "window lengths, as in 20,40 (default 40)");
  add_setting(command, "--safety-factor", tune.safety_factor, "multiplies t_r (default 1)");
  command.add_flag("--write", tune.write, "keep them in the database");
  add_setting(command, "--format", tune.format,
              "of the table: text (default), csv, markdown or latex");
}

}  // namespace vpr
