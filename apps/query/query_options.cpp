// The flags of the commands of vpr-query, and what they name.
#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/named_table.h"
#include "base/text.h"
#include "fabmap/place_query.h"
#include "loops/loops.h"
#include "match/match.h"
#include "present/result_text.h"
#include "query.h"
#include "recordings/sequence.h"
#include "recordings/sequence_source.h"
#include "truth/times.h"

namespace vpr {
namespace {

// Both families have a gap in frames, sequences also a gap in seconds.
void set_loop_gap(const std::string& text, SequenceKeys& sequence, FabmapQuerySettings& fabmap) {
  constexpr const char* kFlag = "--gap";
  sequence.loop_gap = 0;
  sequence.loop_gap_s = 0;
  if (text.ends_with('s')) {
    const LoopGap gap = parse_loop_gap(text, kFlag);
    sequence.loop_gap_s = static_cast<double>(*gap.nanoseconds) / double{kSecond};
    return;
  }
  value_from_json(flag_value(text), fabmap.loop_gap, "command line", kFlag);
  sequence.loop_gap = fabmap.loop_gap;
}

// The query of every command with frames.
void add_query_flags(const Command& command, QueryOptions& options) {
  command.add_option("--query", options.query,
                     "query sequence: folder, list, video or descriptors (.npy), "
                     "PATH[@FIRST:LAST[:STEP]]; with --dataset, the name of one of its queries");
  command.add_option("--dataset", options.dataset, "data set description with the query",
                     kQueryGroup);
}

void add_selection_flags(const Command& command, QueryOptions& options) {
  add_rate_flags(command, options.selection, "the query", kQueryGroup);
  command.add_option("--query-times", options.query_times,
                     "times of the query frames, for --fps: a list, a folder of images with times "
                     "as names, or a video",
                     kQueryGroup, "FILE");
}

// Live queries refuse OpenABLE, LSH and FAB-MAP (query/choices.cpp).
void add_method_flag(const Command& command, AllSettings& settings, bool is_live,
                     const std::string& help) {
  std::vector<std::string> names;
  std::string text = "Methods:\n";
  const auto add = [&](std::string_view name, std::string_view summary) {
    names.emplace_back(name);
    text += fmt::format("  {:<17}{}\n", name, summary);
  };
  for (const SequenceMethod& method : sequence_methods())
    if (!is_live || (method.name != "openable" && !method.is_approximate()))
      add(method.name, method.summary);
  if (!is_live) names.emplace_back(enum_name(DatabaseFamily::fabmap));
  add_setting(command, "--method", settings.sequence.windows.windows.method, help)
      .choices("METHOD", names);
  command.add_footer(text);
}

void add_matrix_output(const Command& command, QueryOptions& options) {
  command.add_option(
      "--save-matrix", options.matrix,
      "write the score matrix: .npy (int32, never whole in memory) or .png (dark: close)",
      kWindowGroup, "FILE");
}

// The flags of sequence methods, and the memory that they use.
void add_sequence_flags(const Command& command, QueryOptions& options, SequenceKeys& settings,
                        QueryCommand name) {
  add_settings(command, settings, sequence_setting_rows(), name);
  add_memory_flag(command, options.memory_limit);
}

void add_fabmap_flags(const Command& command, QueryOptions& options,
                      FabmapQuerySettings& settings) {
  add_settings(command, settings, fabmap_setting_rows(), QueryCommand::query);
  command.add_flag("--motion-model", settings.posterior.motion_model,
                   "raise the prior of places next to the previous place", kFabmapGroup);
  command.add_option("--save-posteriors", options.posteriors,
                     "write frames x (1 + views) probabilities, new place first (.npy)",
                     kFabmapGroup);
  std::string text = "Variants of FAB-MAP:\n";
  for (const FabmapVariant& variant : fabmap_variants())
    text += fmt::format("  {:<17}{}\n", variant.name, variant.summary);
  command.add_footer(text);
}

}  // namespace

void add_match_flags(const Command& command, QueryOptions& options, AllSettings& settings) {
  command.add_option("DB", options.database, "database of vpr-train");
  add_query_flags(command, options);
  add_method_flag(
      command, settings, false,
      "matching method (default: filter); flags of windows select fastable, which is for "
      "equal speed; FAB-MAP databases have the method fabmap");
  add_selection_flags(command, options);
  add_speed_flag(command, options.selection.speed).group(kQueryGroup);
  add_sequence_flags(command, options, settings.sequence, QueryCommand::query);
  add_matrix_output(command, options);
  add_fabmap_flags(command, options, settings.fabmap);
}

void add_live_flags(const Command& command, QueryOptions& options, AllSettings& settings) {
  command.add_option("DB", options.database, "database of vpr-train").required();
  command.add_option("--query", options.query,
                     "folder, list, video, camera (/dev/video0), or - for image paths on standard "
                     "input, one per line; new images of a folder come from inotifywait (example "
                     "below); with --dataset, the name of one of its queries");
  command.add_option("--dataset", options.dataset, "data set description with the query",
                     kQueryGroup);
  add_method_flag(command, settings, true,
                  "matching method (default: filter); flags of windows select fastable");
  add_rate_flags(command, options.selection, "the query", kQueryGroup);
  add_sequence_flags(command, options, settings.sequence, QueryCommand::live);
  command.remove_flag("--output");
}

void add_loop_flags(const Command& command, QueryOptions& options, AllSettings& settings) {
  command.add_option(
      "DB", options.database,
      "FAB-MAP database, whose places come before those of the query; omit it for windows");
  add_query_flags(command, options);
  command.add_option(
      "--gap",
      [&](const std::string& text) { set_loop_gap(text, settings.sequence, settings.fabmap); },
      "minimum time between a frame and its match, in frames (300) or seconds (30s); for FAB-MAP, "
      "the frames in between (default: 10)",
      kEssentialGroup, "TIME");
  command.add_option("--save-loops", options.loop_list,
                     "write one line query,match,score per best match, for vpr-eval loops; only "
                     "recognitions with --t-r or --margin",
                     kEssentialGroup, "FILE");
  command.add_option("--frame-times", options.frame_times,
                     "times of the frames for a gap in seconds: a list with one per line (default: "
                     "from the video, names of images, or the rate of the data set)",
                     kQueryGroup, "FILE");
  add_sequence_flags(command, options, settings.sequence, QueryCommand::loops);
  add_matrix_output(command, options);
  add_fabmap_flags(command, options, settings.fabmap);
}

NamedSequence find_query(const QueryOptions& options, const Session& session) {
  NamedSequence named;
  std::optional<Dataset> dataset;
  std::filesystem::path times = options.query_times;
  refuse(!times.empty() && !options.selection.fps, "--query-times",
         "has an effect with --fps only");
  if (options.dataset.empty()) {
    if (!options.query) throw Error(ErrorKind::usage, "the query is missing, as in --query FOLDER");
    const SequenceArgument argument = parse_sequence_argument(*options.query);
    named = {sequence_names({argument}).front(), argument};
  } else {
    dataset = read_dataset(options.dataset);
    const DatasetQuery& query = select_query(*dataset, options.query);
    named = query.sequence;
    if (times.empty() && query.sequence_ground_truth)
      times = query.sequence_ground_truth->options.query.times;
  }
  if (!is_camera(named.sequence.path))
    named.sequence =
        selected(named.sequence, options.selection, times, dataset ? &*dataset : nullptr, session);
  return named;
}

QueryResources resources_of(const QueryOptions& options, const Session& session) {
  return {options.memory_limit, session.options.process.seed};
}

void claim_outputs(const QueryOptions& options, const Session& session) {
  const std::string& output = session.options.output;
  if (!output.empty()) claim_result(output, session.outputs);
  if (!options.matrix.empty() && !options.matrix.ends_with(".npy") &&
      !options.matrix.ends_with(".png"))
    throw Error(ErrorKind::usage, "--save-matrix writes .npy or .png, found {}", options.matrix);
  for (const std::string& file : {options.matrix, options.posteriors, options.loop_list})
    if (!file.empty()) session.outputs.claim_file(file);
}

ResultContext make_context(const QueryOptions& options, const Session& session) {
  ResultContext context;
  context.run = session.run;
  if (!options.database.empty()) context.run.paths["database"] = options.database;
  return context;
}

Json save_result(const Session& session, const Result& result, const ResultContext& context) {
  const std::string& output = session.options.output;
  return output.empty() ? result_json(result, context)
                        : write_result(output, result, context, session.outputs);
}

void save_loops(const QueryOptions& options, const Result& result, const Session& session) {
  if (!options.loop_list.empty())
    session.outputs.file(options.loop_list).write(loops_csv(loops_of(result)));
}

std::string summary_text(const Result& result, const QueryOptions& options,
                         const Session& session) {
  constexpr size_t kRanges = 6;
  const std::string selection = selection_text(result.query.selection);
  const std::string query =
      fmt::format("{} of {}{}", counted(result.query.frames, "frame"), result.query.name,
                  selection.empty() ? "" : ", " + selection);
  const size_t recognized = recognized_windows(result);
  const auto matched = static_cast<size_t>(
      std::ranges::count_if(result.best, [](const auto& best) { return best.has_value(); }));
  const size_t found = has_rule(result) ? recognized : matched;
  std::string text = fmt::format("{} {} of {}", has_rule(result) ? "Recognized" : "Matched",
                                 found == 0 ? "none" : std::to_string(found), query);
  if (result.places && result.places->featureless > 0)
    text += fmt::format("; {} without features", counted(result.places->featureless, "frame"));
  text += recognized == 0 ? ".\n" : ":\n";
  text += ranges_text(result, recognized_ranges(result),
                      session.options.verbose ? SIZE_MAX : kRanges, "shorter range");
  text += fmt::format("Settings: {}\n", settings_text(result));
  if (result.path && result.path->keyframes)
    text += fmt::format("Keyframes: {} of {}\n", *result.path->keyframes,
                        counted(result.query.frames, "frame"));
  if (result.path && result.path->reversed_frames)
    text += fmt::format("Chance: {} match the training sequences played backward\n",
                        counted(*result.path->reversed_frames, "frame"));
  const std::string& output = session.options.output;
  if (output.empty() || found == 0) return text;
  if (is_loop(result.settings))
    return text + fmt::format("next: vpr-eval loops {} --poses FILE --radius METERS --gap TIME\n",
                              shell_word(output));
  const auto family = result.places ? DatabaseFamily::fabmap : DatabaseFamily::sequences;
  const bool has_truth =
      !options.dataset.empty() &&
      ground_truth_of(select_query(read_dataset(options.dataset), options.query), family, {});
  return text + fmt::format(
                    "next: vpr-eval {} {}, or --html FILE without one\n", shell_word(output),
                    has_truth ? "--dataset " + shell_word(options.dataset) : "--ground-truth FILE");
}

}  // namespace vpr
