// vpr-tune threshold: the automatic t_r, and why it is what it is.
#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "database/archive.h"
#include "number_lists.h"
#include "pipeline/score_basis.h"
#include "pipeline/train.h"
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

/// Closest windows of one length, and the t_r of each sequence that has a window.
struct Automatic {
  ThresholdTable table;
  std::vector<std::optional<AutomaticThreshold>> thresholds;
};

// What a query with such thresholds would be set to.
SequenceQuerySettings query_settings(const ThresholdTune& command) {
  SequenceQuerySettings settings;
  settings.score = command.score;
  if (command.safety_factor != 1) settings.safety_factor = command.safety_factor;
  settings.safety_margin = command.safety_margin;
  settings.standardization = command.standardization;
  return settings;
}

Automatic find_thresholds(const Session& session, const SequenceQuerySettings& settings,
                          const SequenceDatabase& database, size_t memory_limit) {
  const MatchSettings match{settings.window_length, memory_limit, session.kernels};
  Automatic automatic{closest_windows(database, settings, match, session.monitor), {}};
  if (score_kind(settings.score).is_stored)
    warn_of_overlaps(database, automatic.table, session.monitor);
  for (size_t s = 0; s < database.sequences.size(); ++s)
    automatic.thresholds.push_back(
        sequence_threshold(database, automatic.table, s, settings, session.monitor));
  return automatic;
}

void check_command(const Session& session, const ThresholdTune& command) {
  check_safety_factor(command.safety_factor);
  check_score(query_settings(command));
  if (!score_kind(command.score).is_stored && command.write)
    throw Error(ErrorKind::usage,
                "a database keeps thresholds of raw distances only: those of standardized scores "
                "depend on the settings of each query; leave --write out");
  session.claim_output();
  if (!command.write) return;
  session.outputs.extend(command.database);
  session.outputs.claim_folder(command.database, is_database_folder);
}

Json head_json(const ThresholdTune& command) {
  const Json settings = value_to_json(command);
  Json json = {{"schema", "vpr.thresholds/1"}};
  for (const std::string_view key : score_kind(command.score).settings) json[key] = settings[key];
  return json;
}

/// What is listed, for people and for scripts.
struct Listing {
  Table table;
  Json json;
};

std::string threshold_column(ThresholdScale scale) {
  switch (scale) {
    case ThresholdScale::mean_z:
      return "t_r (mean z)";
    case ThresholdScale::mean:
      return "t_r (of mean)";
    case ThresholdScale::relative:
    case ThresholdScale::bits:
      break;
  }
  return "t_r (bits)";
}

void list_thresholds(const SequenceDatabase& database, const Automatic& automatic,
                     const ScoreKind& kind, Listing& listing) {
  const size_t length = automatic.table.window_length;
  for (size_t s = 0; s < database.sequences.size(); ++s) {
    const TrainSequence& own = database.sequences[s];
    const auto& closest = automatic.table.closest[s];
    const auto& t_r = automatic.thresholds[s];
    std::vector<std::string>& row = listing.table.rows.emplace_back();
    row = {own.name, std::to_string(length), "-", "-", "-", "-"};
    Json item = {{"sequence", own.name}, {"c_l", length}, {"t_r", nullptr}};
    if (t_r) {
      item["t_r"] = t_r->value;
      item["t_r_scale"] = enum_name(t_r->scale);
      item["limited"] = t_r->is_largest;
      row[2] = fmt::format("{:.{}f}", t_r->value, t_r->scale == ThresholdScale::mean ? 3 : 2);
      row[3] = t_r->is_largest ? "upper limit" : "closest windows";
    }
    if (closest) {
      const TrainSequence& other = database.sequences[closest->other_sequence];
      row[4] = frame_span(own, closest->window, length);
      row[5] = frame_span(other, closest->other_window, length);
      item["distance"] = closest->distance - kind.offset(length);
      item["own_frames"] = row[4];
      item["closest_frames"] = row[5];
    }
    listing.json["thresholds"].push_back(item);
  }
}

void tune_threshold(Session& session, const ThresholdTune& command) {
  check_command(session, command);
  const ScoreKind& kind = score_kind(command.score);
  SequenceQuerySettings settings = query_settings(command);
  SequenceDatabase database = read_sequence_database(command.database);
  if (kind.needs_statistics) ensure_statistics(database, session.monitor);
  Listing listing{{}, head_json(command)};
  listing.table.title =
      fmt::format("{}: automatic {}", command.database, kind.automatic_title(settings));
  listing.table.columns = {
      "sequence", "c_l",        threshold_column(automatic_scale(database, settings)),
      "from",     "own frames", "closest other frames"};
  listing.json["thresholds"] = Json::array();
  for (const uint64_t length : parse_counts(command.windows, "--c-l")) {
    settings.window_length = length;
    check_score(settings);
    const Automatic automatic = find_thresholds(session, settings, database, command.memory_limit);
    list_thresholds(database, automatic, kind, listing);
    if (command.write) {
      std::erase_if(database.thresholds,
                    [&](const ThresholdTable& stored) { return stored.window_length == length; });
      database.thresholds.push_back(automatic.table);
    }
  }
  if (command.write) write_sequence_database(command.database, database, session.outputs);
  listing.json["provenance"] = provenance_json(session.run);
  session.write_output(listing.json);
  session.print_result(render_table(listing.table, command.format), listing.json);
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
  add_setting(command, "--score", tune.score,
              "raw (default), standardized or standardized-offline");
  add_setting(command, "--safety-margin", tune.safety_margin,
              "taken from t_r of standardized scores (default 0)");
  command.add_flag("--write", tune.write, "keep them in the database");
  add_memory_flag(command, tune.memory_limit, "for the ring of standardized scores, as in 512M");
  add_setting(command, "--format", tune.format,
              "of the table: text (default), csv, markdown or latex");
}

}  // namespace vpr
