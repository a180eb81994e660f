// vpr-query: recognizes the places of a query.
#include <algorithm>
#include <array>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "base/error.h"
#include "database/archive.h"
#include "fabmap/place_query.h"
#include "match/match.h"
#include "query.h"
#include "query/choices.h"

namespace vpr {
namespace {

/// A command of vpr-query; the program itself has no name.
struct CommandRow {
  const char* name;
  QueryCommand command;
  const char* description;
  void (*add_flags)(const Command& command, QueryOptions& options, AllSettings& settings);
  const char* example;
};

constexpr std::array<CommandRow, 3> kCommands = {
    {{"", QueryCommand::query, "Recognize the places of a query sequence in a database.",
      add_match_flags,
      "  vpr-query corridor.vprdb --query tuesday -o result.json\n"
      "  vpr-query corridor.vprdb --query tuesday --c-l 20 --t-r 0.65 -o result.json\n"
      "  vpr-query corridor.vprdb --query wednesday --config result.json"},
     {"live", QueryCommand::live,
      "Match each frame as it arrives, and print one line of JSON per frame.", add_live_flags,
      "  vpr-query live corridor.vprdb --query tuesday.txt\n"
      "  vpr-query live corridor.vprdb --query /dev/video0@30::4\n"
      "  ls images/*.jpg | vpr-query live corridor.vprdb --query - --c-l 20 --score zscore "
      "--decide margin\n"
      "  inotifywait -m -q -e close_write -e moved_to --format '%w%f' images | vpr-query live "
      "corridor.vprdb --query -"},
     {"loops", QueryCommand::loops, "Match a sequence with its own earlier frames.", add_loop_flags,
      "  vpr-query loops --query building/laps --gap 60 --c-l 10 --save-loops loops.csv\n"
      "  vpr-query loops --query laps.mp4 --gap 30s --score zscore -o loops.json\n"
      "  vpr-query loops fabmap.vprdb --query laps --gap 60 --t-p 0.9"}}};

/// Flags of sequences and their counterparts for FAB-MAP.
constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kCounterparts = {
    {{"--save-matrix", "--save-posteriors"}, {"--t-r", "--t-p"}, {"--c-l", "--c-w"}}};

std::string counterpart_text(const std::string& flag) {
  for (const auto& [sequence, fabmap] : kCounterparts)
    if (flag == sequence || flag == fabmap)
      return fmt::format("; use {} instead", flag == sequence ? fabmap : sequence);
  return "";
}

// Refuses a given flag of the other family.
void refuse_other(bool is_given, const std::string& flag, DatabaseFamily family) {
  refuse(is_given, flag,
         fmt::format("has no effect with a {}{}", family_text(family), counterpart_text(flag)));
}

// Refuses flags and configuration keys of the other family, which would have no effect.
template <class Own, class Other>
void refuse_keys_of(const Session& session, DatabaseFamily family) {
  std::vector<std::string> own;
  Own own_settings;
  visit_fields(own_settings,
               [&](const char* key, auto&, const auto&...) { own.emplace_back(key); });
  Other others;
  visit_fields(others, [&](const char* key, auto&, const auto&...) {
    if (std::ranges::count(own, key) > 0) return;
    refuse_other(session.command.is_given(flag_of(key)), flag_of(key), family);
    if (std::ranges::count(session.options.config_keys, key) > 0)
      throw Error(ErrorKind::usage, "{}: {} has no effect with a {}", session.options.config, key,
                  family_text(family));
  });
}

SequenceQuerySettings parse_sequences(const Session& session, const QueryOptions& options,
                                      const SequenceKeys& keys, QueryCommand command) {
  constexpr DatabaseFamily kFamily = DatabaseFamily::sequences;
  refuse_other(!options.posteriors.empty(), "--save-posteriors", kFamily);
  refuse_other(session.command.is_given("--motion-model"), "--motion-model", kFamily);
  refuse_keys_of<SequenceKeys, FabmapQuerySettings>(session, kFamily);
  refuse(command == QueryCommand::loops && !options.database.empty(), "DB",
         "does not go with vpr-query loops, except for FAB-MAP. Omit it");
  SequenceQuerySettings settings = choose_query(keys, given_keys<SequenceKeys>(session), command);
  constexpr double kLowMargin = 12;  // at 10, floors that look alike are confused
  const auto* filter = std::get_if<Filter>(&settings.rule);
  if (filter != nullptr && filter->margin < kLowMargin)
    warn(session.monitor,
         "--margin {:g} is low: the filter counts deviations (default: {:g}), and may recognize "
         "other places",
         filter->margin, kFilterMargin);
  refuse(!options.matrix.empty() && std::holds_alternative<Lsh>(settings.rule), "--save-matrix",
         "does not go with --method lsh, which omits scores. Omit it");
  return settings;
}

FabmapQuerySettings parse_places(const Session& session, const QueryOptions& options,
                                 const AllSettings& settings, QueryCommand command) {
  constexpr DatabaseFamily kFamily = DatabaseFamily::fabmap;
  if (command == QueryCommand::live)
    throw Error(ErrorKind::data, "{} is a {}, which {} cannot use", options.database,
                family_text(kFamily), enum_name(command));
  refuse_other(!options.matrix.empty(), "--save-matrix", kFamily);
  refuse_other(session.command.is_given("--max-memory"), "--max-memory", kFamily);
  refuse_keys_of<FabmapQuerySettings, SequenceKeys>(session, kFamily);
  refuse(settings.sequence.loop_gap_s != 0, "a --gap in seconds",
         "does not go with a FAB-MAP database. Use a gap in frames, as in --gap 30");
  FabmapQuerySettings places = settings.fabmap;
  places.method = enum_name(kFamily);
  places.skip_unreadable = settings.sequence.skip_unreadable;
  places.loop = command == QueryCommand::loops;
  return places;
}

// The family of the database; sequences without a database.
DatabaseFamily family_of(const QueryOptions& options, bool needs_database) {
  if (!options.database.empty()) return database_family(options.database);
  if (!needs_database) return DatabaseFamily::sequences;
  throw Error(ErrorKind::usage, "the database is missing, as in vpr-query DB --query FOLDER");
}

// Throws Error(usage) for an unknown method, and Error(data) for one of the other family.
void check_method(const std::string& method, const QueryOptions& options, DatabaseFamily family) {
  const bool is_fabmap = method == enum_name(DatabaseFamily::fabmap);
  if (!is_fabmap) find_sequence_method(method);
  if (is_fabmap != (family == DatabaseFamily::fabmap))
    throw Error(ErrorKind::data, "{} is a {}, which {} cannot use", options.database,
                family_text(family), method);
}

// The query that the command line asks for: of sequences, or of places. Throws Error(usage) for
// flags that do not go together, and Error(data) for a database that the command cannot use.
QuerySettings parse_query(const Session& session, const QueryOptions& options,
                          const AllSettings& settings, QueryCommand command) {
  if (!options.selection.speed.empty()) check_speed(options.selection.speed);
  const bool is_loop = command == QueryCommand::loops;
  if (settings.sequence.loop && !is_loop)
    throw Error(ErrorKind::usage, "{}: has the settings of vpr-query loops",
                session.options.config);
  refuse(!options.frame_times.empty() && settings.sequence.loop_gap_s == 0, "--frame-times",
         "needs a gap in seconds, as in --gap 30s");
  const DatabaseFamily family = family_of(options, !is_loop);
  const std::vector<std::string> given = given_keys<SequenceKeys>(session);
  if (std::ranges::count(given, "method") > 0)
    check_method(settings.sequence.windows.windows.method, options, family);
  if (family == DatabaseFamily::fabmap) return parse_places(session, options, settings, command);
  return parse_sequences(session, options, settings.sequence, command);
}

void run(Session& session, const QueryOptions& options, const AllSettings& settings,
         QueryCommand command) {
  const QuerySettings query = parse_query(session, options, settings, command);
  if (const auto* places = std::get_if<FabmapQuerySettings>(&query))
    return query_places(session, options, *places);
  const auto& sequences = std::get<SequenceQuerySettings>(query);
  command == QueryCommand::live ? query_live(session, options, sequences)
                                : query_sequences(session, options, sequences);
}

}  // namespace
}  // namespace vpr

int main(int argc, char** argv) {
  using namespace vpr;
  const CommandRow& match = kCommands.front();
  Program program("vpr-query", match.description, match.example);
  QueryOptions options;
  AllSettings settings;
  for (const CommandRow& command : kCommands) {
    const auto run_command = [&](Session& session) {
      run(session, options, settings, command.command);
    };
    const bool is_program = &command == &match;
    const Command flags = is_program ? program.command()
                                     : program.add_command(command.name, command.description,
                                                           command.example, run_command);
    command.add_flags(flags, options, settings);
    program.add_config(flags, settings);
    if (is_program) program.set_run(run_command);
  }
  return program.main(argc, argv);
}
