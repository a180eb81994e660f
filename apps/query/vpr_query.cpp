// vpr-query: where does a query sequence match a database?
#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "fabmap/model.h"
#include "match/lsh.h"
#include "match/match.h"
#include "query_flags.h"
#include "query_inputs.h"
#include "sequence/selection.h"
#include "store/archive.h"

namespace vpr {
namespace {

/// Settings of either family; the database decides which of them count.
struct GivenSettings {
  SequenceQuerySettings sequence;
  FabmapQuerySettings fabmap;
  std::string method;  ///< empty: the database's
};

template <class Visitor>
void visit_fields(GivenSettings& settings, Visitor&& visit) {
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

// Tables of what --method and --variant take.
std::string method_help() {
  std::string text = "Methods:\n";
  for (const SequenceMethod& method : sequence_methods())
    text += fmt::format("  {:<17}{}\n", method.name, method.summary);
  text += fmt::format("  {:<17}{}\n", kLshMethod, kLshSummary);
  text += "\nVariants of FAB-MAP:\n";
  for (const FabmapVariant& variant : fabmap_variants())
    text += fmt::format("  {:<17}{}\n", variant.name, variant.summary);
  text +=
      "\nBoth together:\n"
      "  --fuse FABMAP.vprdb adds what FAB-MAP says of each frame to z-scores:\n"
      "  --fuse-beta deviations for each nat that a training frame is behind the likeliest one,\n"
      "  and more, or less, as FAB-MAP's matches go along with the walk better or worse than\n"
      "  those of scores. Train both databases with the same sequences.\n";
  return text;
}

/// Flags that do for one family what the other's does.
constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kCounterparts = {
    {{"--save-matrix", "--save-posteriors"}, {"--t-r", "--t-p"}, {"--c-l", "--c-w"}}};

std::string counterpart_text(const std::string& flag) {
  for (const auto& [sequence, fabmap] : kCounterparts)
    if (flag == sequence || flag == fabmap)
      return fmt::format("; its counterpart there is {}", flag == sequence ? fabmap : sequence);
  return "";
}

template <class S>
std::vector<std::string> keys_of(S settings) {
  std::vector<std::string> keys;
  visit_fields(settings, [&](const char* key, auto&) { keys.emplace_back(key); });
  return keys;
}

/// How databases of one family are queried, and what means nothing to them.
struct FamilyQuery {
  void (*run)(Session& session, const QueryInputs& inputs, const GivenSettings& settings,
              const RunChoices& run);
  std::vector<std::string> (*keys)();  ///< of configurations
  std::array<const char*, 3> foreign_groups;
};

/// A row for each DatabaseFamily.
constexpr std::array<FamilyQuery, 2> kFamilies = {{
    {[](Session& session, const QueryInputs& inputs, const GivenSettings& settings,
        const RunChoices& run) {
       run_sequence_query(session, inputs, {settings.sequence, run});
     },
     [] { return keys_of(SequenceQuerySettings{}); },
     {kFabmapGroup, nullptr, nullptr}},
    {[](Session& session, const QueryInputs& inputs, const GivenSettings& settings,
        const RunChoices& run) {
       check_choices(settings.sequence, run);
       run_fabmap_query(session, inputs, settings.fabmap);
     },
     [] { return keys_of(FabmapQuerySettings{}); },
     {kSequenceGroup, kGroundTruthGroup, kScoreGroup}},
}};

// A flag of the other family would be without effect: say so instead.
void refuse_flags(const Command& app, const FamilyQuery& family, std::string_view kind) {
  for (const char* group : family.foreign_groups) {
    if (group == nullptr) continue;
    for (const std::string& flag : app.given_flags(group))
      throw Error(ErrorKind::usage, fmt::format("{} has no effect with a database for {}{}", flag,
                                                kind, counterpart_text(flag)));
  }
}

// So would a key of the configuration.
void refuse_keys(const CommonOptions& options, const FamilyQuery& family, std::string_view kind) {
  const auto has = [](const std::vector<std::string>& keys, const std::string& key) {
    return std::find(keys.begin(), keys.end(), key) != keys.end();
  };
  const std::vector<std::string> own = family.keys();
  for (const std::string& key : options.config_keys)
    for (const FamilyQuery& other : kFamilies)
      if (has(other.keys(), key) && !has(own, key))
        throw Error(ErrorKind::usage, fmt::format("{}: {} has no effect with a database for {}",
                                                  options.config, key, kind));
}

// What a run has besides settings. Settings that are given and that the method or --fuse replaces
// are choices, too, unless they have the value that is implied.
RunChoices choices_of(const Command& app, const CommonOptions& options, const QueryInputs& inputs,
                      const SequenceQuerySettings& settings, DatabaseFamily family) {
  RunChoices run;
  for (const Choice& choice : choices())
    if (choice.flag.starts_with("--") && !choice.is_implied &&
        app.is_given(std::string(choice.flag)))
      run.push_back(choice.flag);
  std::erase_if(run, [&](std::string_view flag) {
    return (flag == "--c-l" && settings.window_length == 1) ||
           (flag == "--verify" && inputs.verify_cells == 0);
  });
  if (family == DatabaseFamily::fabmap) run.push_back(kFabmapChoice);
  if (family == DatabaseFamily::sequences && !inputs.database.empty())
    run.push_back(kDatabaseChoice);
  if (!inputs.fuse.empty()) run.emplace_back("--fuse");
  if (asks_for_truth(inputs)) run.emplace_back("--ground-truth");
  if (inputs.matrix.ends_with(".png")) run.emplace_back("--save-matrix FILE.png");
  const auto is_given = [&](const char* flag, const char* key) {
    return app.is_given(flag) ||
           std::ranges::find(options.config_keys, key) != options.config_keys.end();
  };
  if (is_given("--c-l", "c_l") && settings.window_length != 1) run.emplace_back("--c-l");
  if (is_given("--score", "score") && settings.score == Score::raw) run.emplace_back("--score raw");
  if (is_given("--decide", "decide") && settings.decision == Decision::threshold)
    run.emplace_back("--decide threshold");
  return run;
}

/// A matrix of scores is one of frames of sequences, and so is a walk without a database.
DatabaseFamily family_of(const QueryInputs& inputs, bool is_loop) {
  if (!inputs.scores.matrix.path.empty()) return DatabaseFamily::sequences;
  if (is_loop && inputs.database.empty()) return DatabaseFamily::sequences;
  if (inputs.database.empty())
    throw Error(
        ErrorKind::usage,
        "give the database, as in vpr-query DB --query FOLDER, or a matrix of scores, as in "
        "--scores S.npy --similarity");
  return database_family(inputs.database);
}

/// Throws Error(usage) for a method that there is not.
DatabaseFamily family_of(const std::string& method) {
  if (method == enum_name(DatabaseFamily::fabmap)) return DatabaseFamily::fabmap;
  if (method != kLshMethod) find_sequence_method(method);
  return DatabaseFamily::sequences;
}

void run(Session& session, const QueryInputs& inputs, const GivenSettings& given,
         const Command& app) {
  GivenSettings settings = given;
  if (!inputs.selection.warp.empty()) check_warp(inputs.selection.warp);
  const DatabaseFamily family = family_of(inputs, settings.fabmap.loop);
  const std::string_view kind = enum_name(family);
  const std::string method = settings.method.empty() ? std::string(kind) : settings.method;
  if (family_of(method) != family)
    throw Error(ErrorKind::data, fmt::format("{}: is a database for {}, which {} can't use",
                                             inputs.database, kind, method));
  const FamilyQuery& query = kFamilies[static_cast<size_t>(family)];
  refuse_flags(app, query, kind);
  refuse_keys(session.options, query, kind);
  settings.sequence.method = settings.fabmap.method = method;
  settings.fabmap.skip_unreadable = settings.sequence.skip_unreadable;
  settings.sequence.loop = settings.fabmap.loop;
  query.run(session, inputs, settings,
            choices_of(app, session.options, inputs, settings.sequence, family));
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
                  "  vpr-query corridor.vprdb --query tuesday --warp varying --seed 2 -o r.json\n"
                  "  vpr-query corridor.vprdb --query tuesday.mp4 --fps 5 -o r.json\n"
                  "  vpr-query corridor.vprdb --query tuesday --fuse fabmap.vprdb --c-l 5\n"
                  "  vpr-query fabmap.vprdb --query walk --t-p 0.6 --c-w 3 -o result.json");
  QueryInputs inputs;
  GivenSettings settings;
  const Command app = program.command();
  add_inputs(app, inputs);
  program.add_config(app, settings);
  add_setting(app, "--method", settings.method, "default: the database's")
      .choices("METHOD", method_names());
  app.add_footer(method_help());
  add_unreadable_flag(app, settings.sequence.skip_unreadable);
  add_sequence_flags(app, inputs, settings.sequence);
  add_ground_truth_flags(app, inputs.flags);
  add_fabmap_flags(app, inputs, settings.fabmap);
  add_loop_flags(app, inputs.loop, settings.sequence, settings.fabmap);
  program.set_run([&](Session& session) { run(session, inputs, settings, app); });
  return program.main(argc, argv);
}
