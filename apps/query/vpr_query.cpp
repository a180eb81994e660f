// vpr-query: recognizes the places of a query.
#include <algorithm>
#include <array>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "base/error.h"
#include "fabmap/place_query.h"
#include "match/match.h"
#include "query.h"
#include "store/archive.h"

namespace vpr {
namespace {

/// A command of vpr-query; the program itself has no name.
struct QueryCommand {
  const char* name;
  Feature feature;
  const char* description;
  void (*add_flags)(const Command& command, QueryOptions& options, AllSettings& settings);
  const char* example;
};

constexpr std::array<QueryCommand, 3> kCommands = {
    {{"", Feature::query, "Recognize the places of a query sequence in a database.",
      add_match_flags,
      "  vpr-query corridor.vprdb --query tuesday -o result.json\n"
      "  vpr-query corridor.vprdb --query tuesday --c-l 20 --t-r 0.65 -o result.json\n"
      "  vpr-query corridor.vprdb --query wednesday --config result.json"},
     {"live", Feature::live,
      "Match each frame as it arrives, and print one line of JSON per frame.", add_live_flags,
      "  vpr-query live corridor.vprdb --query tuesday.txt\n"
      "  vpr-query live corridor.vprdb --query /dev/video0@30::4\n"
      "  ls images/*.jpg | vpr-query live corridor.vprdb --query - --c-l 20 --score zscore "
      "--decide margin\n"
      "  inotifywait -m -q -e close_write -e moved_to --format '%w%f' images | vpr-query live "
      "corridor.vprdb --query -"},
     {"loops", Feature::loops, "Match a sequence with its own earlier frames.", add_loop_flags,
      "  vpr-query loops --query laps --gap 60 --c-l 10 --save-loops loops.csv\n"
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

template <class S>
std::vector<std::string> keys_of(S settings) {
  std::vector<std::string> keys;
  visit_fields(settings, [&](const char* key, auto&) { keys.emplace_back(key); });
  return keys;
}

// Refuses flags and configuration keys of the other family, which would have no effect.
void refuse_foreign(const Session& session, DatabaseFamily family) {
  const bool is_fabmap = family == DatabaseFamily::fabmap;
  const auto refuse_flag = [&](const std::string& flag) {
    throw Error(ErrorKind::usage, "{} has no effect with a database for {}{}", flag,
                enum_name(family), counterpart_text(flag));
  };
  for (const std::string& flag :
       session.command.given_flags(is_fabmap ? kWindowGroup : kFabmapGroup))
    refuse_flag(flag);
  auto own_keys = keys_of(SequenceQuerySettings{});
  auto foreign_keys = keys_of(FabmapQuerySettings{});
  if (is_fabmap) std::swap(own_keys, foreign_keys);
  for (const std::string& key : foreign_keys) {
    if (std::ranges::count(own_keys, key) > 0) continue;
    if (session.command.is_given(flag_of(key))) refuse_flag(flag_of(key));
    if (std::ranges::count(session.options.config_keys, key) > 0)
      throw Error(ErrorKind::usage, "{}: {} has no effect with a database for {}",
                  session.options.config, key, enum_name(family));
  }
}

// Keys of settings on the command line and in the configuration file.
std::vector<std::string> given_settings(const Session& session) {
  std::vector<std::string> keys = session.options.config_keys;
  for (const std::string& key : keys_of(SequenceQuerySettings{}))
    if (session.command.is_given(flag_of(key))) keys.push_back(key);
  return keys;
}

// The choices of a run that are not settings, and those of add_given_features.
Features choices_of(const Session& session, const QueryOptions& options,
                    const SequenceQuerySettings& settings, DatabaseFamily family, Feature command) {
  Features run = {command};
  if (family == DatabaseFamily::fabmap)
    run.push_back(Feature::fabmap);
  else if (!options.database.empty())
    run.push_back(Feature::database);
  if (!options.matrix.empty()) run.push_back(Feature::save_matrix);
  add_given_features(run, settings, given_settings(session));
  return run;
}

// The family of the database; sequences without a database.
DatabaseFamily family_of(const QueryOptions& options, bool needs_database) {
  if (!options.database.empty()) return database_family(options.database);
  if (!needs_database) return DatabaseFamily::sequences;
  throw Error(ErrorKind::usage, "the database is missing, as in vpr-query DB --query FOLDER");
}

// Throws Error(usage) for an unknown method.
DatabaseFamily family_of(const std::string& method) {
  if (method == enum_name(DatabaseFamily::fabmap)) return DatabaseFamily::fabmap;
  find_sequence_method(method);
  return DatabaseFamily::sequences;
}

/// A query of sequences, or of places.
using Query = std::variant<ResolvedSettings, FabmapQuerySettings>;

// The query that the command line asks for. Throws Error(usage) for flags that do not go together,
// and Error(data) for a database of the other family.
Query parse_query(const Session& session, const QueryOptions& options, AllSettings settings,
                  Feature command) {
  if (!options.selection.speed.empty()) check_speed(options.selection.speed);
  const bool is_loop = command == Feature::loops;
  if (settings.fabmap.loop && !is_loop)
    throw Error(ErrorKind::usage, "{}: has the settings of vpr-query loops",
                session.options.config);
  settings.sequence.loop = settings.fabmap.loop = is_loop;
  refuse(!options.frame_times.empty() && settings.sequence.loop_gap_s == 0, "--frame-times",
         "needs a gap in seconds, as in --gap 30s");
  const DatabaseFamily family = family_of(options, !is_loop);
  if (settings.method.empty())
    settings.method = family == DatabaseFamily::fabmap
                          ? enum_name(family)
                          : default_method(command, given_settings(session));
  if (family == DatabaseFamily::fabmap && command == Feature::live)
    throw Error(ErrorKind::data, "{}: is a database for {}, which {} cannot use", options.database,
                enum_name(family), enum_name(command));
  if (family_of(settings.method) != family)
    throw Error(ErrorKind::data, "{}: is a database for {}, which {} cannot use", options.database,
                enum_name(family), settings.method);
  refuse_foreign(session, family);
  settings.sequence.method = settings.fabmap.method = settings.method;
  settings.fabmap.skip_unreadable = settings.sequence.skip_unreadable;
  const Features choices = choices_of(session, options, settings.sequence, family, command);
  if (family == DatabaseFamily::sequences) return ResolvedSettings(settings.sequence, choices);
  check_choices(settings.sequence, choices);
  return settings.fabmap;
}

void run_query(Session& session, const QueryOptions& options, const ResolvedSettings& settings) {
  settings.has(Feature::live) ? query_live(session, options, settings)
                              : query_sequences(session, options, settings);
}

void run_query(Session& session, const QueryOptions& options, const FabmapQuerySettings& settings) {
  query_places(session, options, settings);
}

void run(Session& session, const QueryOptions& options, const AllSettings& settings,
         Feature command) {
  std::visit([&](const auto& query) { run_query(session, options, query); },
             parse_query(session, options, settings, command));
}

}  // namespace
}  // namespace vpr

int main(int argc, char** argv) {
  using namespace vpr;
  const QueryCommand& match = kCommands.front();
  Program program("vpr-query", match.description, match.example);
  QueryOptions options;
  AllSettings settings;
  for (const QueryCommand& command : kCommands) {
    const auto run_command = [&](Session& session) {
      run(session, options, settings, command.feature);
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
