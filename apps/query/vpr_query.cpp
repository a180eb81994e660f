// vpr-query: recognizes the places of a query.
#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "fabmap/model.h"
#include "match/lsh.h"
#include "match/match.h"
#include "query.h"
#include "sequence/sequence.h"
#include "store/archive.h"

namespace vpr {
namespace {

/// The settings of both families of methods; the family of the database uses its own.
struct AllSettings {
  SequenceQuerySettings sequence;
  FabmapQuerySettings fabmap;
  std::string method;  ///< empty: the database's
};

template <class Visitor>
void visit_fields(AllSettings& settings, Visitor&& visit) {
  visit_fields(settings.sequence, visit);
  visit_fields(settings.fabmap, visit);
  visit("method", settings.method);
}

std::vector<std::string> method_names() {
  std::vector<std::string> names;
  for (const SequenceMethod& method : sequence_methods()) names.emplace_back(method.name);
  names.emplace_back(kLshMethod);
  names.emplace_back(enum_name(DatabaseFamily::fabmap));
  return names;
}

std::string method_help() {
  std::string text = "Methods:\n";
  for (const SequenceMethod& method : sequence_methods())
    text += fmt::format("  {:<17}{}\n", method.name, method.summary);
  text += fmt::format("  {:<17}{}\n", kLshMethod, kLshSummary);
  text += "\nVariants of FAB-MAP:\n";
  for (const FabmapVariant& variant : fabmap_variants())
    text += fmt::format("  {:<17}{}\n", variant.name, variant.summary);
  return text +
         "\nFusion:\n"
         "  --fuse FABMAP.vprdb adds to the z-score of each training frame --fusion-weight "
         "standard\n"
         "  deviations per nat by which FAB-MAP's log-likelihood is below the highest one. The\n"
         "  weight is adapted online to the reliability of FAB-MAP. Train both databases with the\n"
         "  same sequences.\n";
}

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
void refuse_foreign(const Command& app, const CommonOptions& common, DatabaseFamily family) {
  const bool is_fabmap = family == DatabaseFamily::fabmap;
  const std::vector<const char*> foreign_groups =
      is_fabmap ? std::vector{kSequenceGroup, kGroundTruthGroup, kScoreGroup}
                : std::vector{kFabmapGroup};
  for (const char* group : foreign_groups)
    for (const std::string& flag : app.given_flags(group))
      throw Error(ErrorKind::usage, fmt::format("{} has no effect with a database for {}{}", flag,
                                                enum_name(family), counterpart_text(flag)));
  auto own_keys = keys_of(SequenceQuerySettings{});
  auto foreign_keys = keys_of(FabmapQuerySettings{});
  if (is_fabmap) std::swap(own_keys, foreign_keys);
  for (const std::string& key : common.config_keys)
    if (std::ranges::count(foreign_keys, key) > 0 && std::ranges::count(own_keys, key) == 0)
      throw Error(ErrorKind::usage, fmt::format("{}: {} has no effect with a database for {}",
                                                common.config, key, enum_name(family)));
}

// The choices of a run that are not settings. Also settings that the method or --fuse would
// replace, if they are given with another value.
RunChoices choices_of(const Command& app, const CommonOptions& common, const QueryOptions& options,
                      const SequenceQuerySettings& settings, DatabaseFamily family) {
  RunChoices run;
  for (const Choice& choice : choices())
    if (choice.flag.starts_with("--") && !choice.is_implied &&
        app.is_given(std::string(choice.flag)))
      run.push_back(choice.flag);
  std::erase_if(run, [&](std::string_view flag) {
    return (flag == "--c-l" && settings.window_length == 1) ||
           (flag == "--verify" && options.verify_cells == 0);
  });
  if (family == DatabaseFamily::fabmap) run.push_back(kFabmapChoice);
  if (family == DatabaseFamily::sequences && !options.database.empty())
    run.push_back(kDatabaseChoice);
  if (!options.fuse.empty()) run.emplace_back("--fuse");
  if (has_ground_truth(options)) run.emplace_back("--ground-truth");
  if (options.matrix.ends_with(".png")) run.emplace_back("--save-matrix FILE.png");
  const auto is_given = [&](const char* flag, const char* key) {
    return app.is_given(flag) || std::ranges::count(common.config_keys, key) > 0;
  };
  if (is_given("--c-l", "c_l") && settings.window_length != 1) run.emplace_back("--c-l");
  if (is_given("--score", "score") && settings.score == Score::raw) run.emplace_back("--score raw");
  if (is_given("--decide", "decide") && settings.decision == Decision::threshold)
    run.emplace_back("--decide threshold");
  return run;
}

// The family of the database; sequences without a database.
DatabaseFamily family_of(const QueryOptions& options, bool is_loop) {
  if (!options.scores.path.empty()) return DatabaseFamily::sequences;
  if (!options.database.empty()) return database_family(options.database);
  if (is_loop) return DatabaseFamily::sequences;
  throw Error(ErrorKind::usage,
              "the database is missing, as in vpr-query DB --query FOLDER, or a score matrix, as "
              "in --scores S.npy --similarity");
}

// Throws Error(usage) for an unknown method.
DatabaseFamily family_of(const std::string& method) {
  if (method == enum_name(DatabaseFamily::fabmap)) return DatabaseFamily::fabmap;
  if (method != kLshMethod) find_sequence_method(method);
  return DatabaseFamily::sequences;
}

void run(Session& session, const QueryOptions& options, AllSettings settings, const Command& app) {
  if (!options.selection.speed.empty()) check_speed(options.selection.speed);
  const DatabaseFamily family = family_of(options, settings.fabmap.loop);
  if (settings.method.empty()) settings.method = enum_name(family);
  if (family_of(settings.method) != family)
    throw Error(ErrorKind::data, fmt::format("{}: is a database for {}, which {} cannot use",
                                             options.database, enum_name(family), settings.method));
  refuse_foreign(app, session.options, family);
  settings.sequence.method = settings.fabmap.method = settings.method;
  settings.fabmap.skip_unreadable = settings.sequence.skip_unreadable;
  settings.sequence.loop = settings.fabmap.loop;
  const RunChoices choices = choices_of(app, session.options, options, settings.sequence, family);
  if (family == DatabaseFamily::fabmap) {
    check_choices(settings.sequence, choices);
    return query_places(session, options, settings.fabmap);
  }
  const ResolvedSettings resolved(settings.sequence, choices);
  options.follow ? follow_query(session, options, resolved)
                 : query_sequences(session, options, resolved);
}

}  // namespace
}  // namespace vpr

int main(int argc, char** argv) {
  using namespace vpr;
  Program program("vpr-query", "Recognize the places of a query sequence in a database.",
                  "  vpr-query corridor.vprdb --query tuesday\n"
                  "  vpr-query corridor.vprdb --query tuesday --c-l 20 --t-r 0.65 -o result.json\n"
                  "  vpr-query corridor.vprdb --query tuesday --score zscore --decide margin "
                  "-o result.json\n"
                  "  vpr-query corridor.vprdb --query frames --method filter --follow\n"
                  "  vpr-query corridor.vprdb --query /dev/video0@30::4 --method filter --follow\n"
                  "  vpr-query corridor.vprdb --query wednesday --config result.json\n"
                  "  vpr-query walk.vprdb --query-npy tuesday.npy --c-l 10 -o result.json\n"
                  "  vpr-query --scores S.npy --similarity --c-l 10 --score zscore -o r.json\n"
                  "  vpr-query --loop --loop-gap 30s --query walk --c-l 20 --save-loops loops.csv\n"
                  "  vpr-query corridor.vprdb --query tuesday --speed varying --seed 2 -o r.json\n"
                  "  vpr-query corridor.vprdb --query tuesday.mp4 --fps 5 -o r.json\n"
                  "  vpr-query corridor.vprdb --query tuesday --fuse fabmap.vprdb --c-l 5\n"
                  "  vpr-query fabmap.vprdb --query walk --t-p 0.6 --c-w 3 -o result.json");
  QueryOptions options;
  AllSettings settings;
  const Command app = program.command();
  add_inputs(app, options);
  program.add_config(app, settings);
  add_setting(app, "--method", settings.method, "matching method (default: the database's)")
      .choices("METHOD", method_names());
  app.add_footer(method_help());
  add_unreadable_flag(app, settings.sequence.skip_unreadable);
  add_sequence_flags(app, options, settings.sequence);
  add_ground_truth_flags(app, options.ground_truth_flags);
  add_fabmap_flags(app, options, settings.fabmap);
  add_loop_flags(app, options, settings.sequence, settings.fabmap);
  program.set_run([&](Session& session) { run(session, options, settings, app); });
  return program.main(argc, argv);
}
