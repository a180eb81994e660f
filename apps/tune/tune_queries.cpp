// Queries with ground truth on the command line of vpr-tune, and commands of vpr-query that use its
// choice.
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/text.h"
#include "match/match.h"
#include "recordings/sequence_source.h"
#include "tune.h"

namespace vpr {
namespace {

Source make_source(const TuneOptions& options, NamedSequence sequence, GroundTruthArgument truth,
                   const Dataset* dataset, const Session& session) {
  sequence.sequence =
      selected(sequence.sequence, options.selection, truth.options.query.times, dataset, session);
  remove_selection_times(truth, options.selection);
  return {sequence, truth};
}

Source find_in_dataset(const TuneOptions& options, const std::string& path, const std::string& name,
                       DatabaseFamily family, const Session& session) {
  const Dataset dataset = read_dataset(path);
  const auto given = name.empty() ? std::nullopt : std::optional(name);
  const DatasetQuery& query = select_query(dataset, given);
  const auto truth = ground_truth_of(query, family, options.ground_truth_flags);
  if (!truth)
    throw Error(ErrorKind::usage, "{}: the query {} has no ground truth", path,
                query.sequence.name);
  return make_source(options, query.sequence, *truth, &dataset, session);
}

Source find_by_path(const TuneOptions& options, const std::string& sequence,
                    const std::string& ground_truth, const Session& session) {
  const SequenceArgument argument = parse_sequence_argument(sequence);
  return make_source(options, {sequence_names({argument}).front(), argument},
                     ground_truth_argument(ground_truth, options.ground_truth_flags), nullptr,
                     session);
}

bool share_frames(const SequenceArgument& a, const SequenceArgument& b) {
  constexpr uint64_t kEnd = std::numeric_limits<uint64_t>::max();
  return a.path == b.path && a.range.first < b.range.last.value_or(kEnd) &&
         b.range.first < a.range.last.value_or(kEnd);
}

// Settings as flags of vpr-query, except its defaults: the filter, and for a c_l raw distances.
std::vector<std::string> setting_flags(const QuerySettings& chosen) {
  const Json settings = settings_in_force(chosen);
  std::vector<std::string> flags;
  const auto add = [&](const char* key) {
    if (!settings.contains(key) || settings[key].is_null()) return;
    const Json& value = settings[key];
    const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
    for (const char* initial : {"auto", "raw", "threshold"})
      if (text == initial) return;
    flags.push_back(fmt::format("{}{}{}", flag_of(key), text.starts_with('-') ? "=" : " ", text));
  };
  if (!has_paths(chosen))
    for (const char* key :
         {"c_l", "t_r", "c_w", "t_p", "score", "decide", "margin", "exclusion_frames"})
      add(key);
  if (settings.value("t_r_scale", "") == enum_name(ThresholdScale::bits))
    flags.emplace_back("--t-r-scale bits");
  if (settings.value("skip_unreadable", false)) flags.emplace_back("--skip-unreadable");
  return flags;
}

}  // namespace

Flag add_query_flags(const Command& command, TuneOptions& options) {
  const Flag database = command.add_option("DB", options.database, "database of vpr-train");
  command.add_option("--query", options.query,
                     "query sequence: folder, list, video or descriptors (.npy); with --dataset, "
                     "the name of one of its queries");
  command.add_option("--ground-truth", options.ground_truth,
                     "places that the query shows; " + ground_truth_help());
  command.add_list("--dataset", options.datasets,
                   "data set description with query and ground truth; repeatable", kQueryGroup);
  add_speed_flag(command, options.selection.speed).group(kQueryGroup);
  add_rate_flags(command, options.selection, "queries", kQueryGroup);
  add_ground_truth_flags(command, options.ground_truth_flags);
  return database;
}

std::vector<Source> find_queries(const TuneOptions& options, DatabaseFamily family,
                                 const Session& session) {
  if (!options.selection.speed.empty()) check_speed(options.selection.speed);
  std::vector<Source> queries;
  for (const std::string& path : options.datasets)
    queries.push_back(find_in_dataset(options, path, options.query, family, session));
  if (!queries.empty()) return queries;
  if (options.query.empty() || options.ground_truth.empty())
    throw Error(ErrorKind::usage,
                "the {} is missing; pass --query and --ground-truth, or --dataset",
                options.query.empty() ? "query" : "ground truth");
  return {find_by_path(options, options.query, options.ground_truth, session)};
}

std::optional<Source> find_validation(const TuneOptions& options, DatabaseFamily family,
                                      const std::vector<Source>& queries, const Session& session) {
  const bool in_dataset = options.validate_ground_truth.empty() && options.datasets.size() == 1;
  if (options.validate.empty() != options.validate_ground_truth.empty() && !in_dataset)
    throw Error(ErrorKind::usage,
                "--validate and --validate-ground-truth belong together; with one --dataset, "
                "--validate is the name of another of its queries");
  if (options.validate.empty()) return std::nullopt;
  const Source validation =
      in_dataset
          ? find_in_dataset(options, options.datasets.front(), options.validate, family, session)
          : find_by_path(options, options.validate, options.validate_ground_truth, session);
  for (const Source& query : queries)
    if (share_frames(query.sequence.sequence, validation.sequence.sequence))
      warn(session.monitor,
           "{}: the settings are chosen on frames of the validation; validate on frames that were "
           "not seen",
           validation.sequence.sequence.path.string());
  return validation;
}

EvaluationSettings evaluation_of(const Source& source, const SequenceDatabase* database) {
  EvaluationSettings by;
  by.ground_truth = source.ground_truth;
  by.query_names = [&source] { return frame_names(source.sequence.sequence); };
  if (database != nullptr)
    for (const TrainSequence& train : database->sequences)
      by.train_names.emplace_back([&train] { return train.sequence.frame_names; });
  return by;
}

std::string query_command(const TuneOptions& options, const CommonOptions& common,
                          const QuerySettings& settings, size_t index) {
  const bool is_other_family =
      !options.fabmap.empty() && std::holds_alternative<FabmapQuerySettings>(settings);
  std::vector<std::string> words = {
      "vpr-query", shell_word(is_other_family ? options.fabmap : options.database)};
  const auto add = [&](const char* flag, const std::string& value) {
    if (!value.empty()) words.push_back(fmt::format("{} {}", flag, shell_word(value)));
  };
  if (!options.datasets.empty()) add("--dataset", options.datasets[index]);
  add("--query", options.query);
  add("--speed", options.selection.speed);
  if (!options.selection.speed.empty() && common.process.seed != 1)
    add("--seed", std::to_string(common.process.seed));
  if (options.selection.fps) add("--fps", fmt::format("{:g}", *options.selection.fps));
  if (options.selection.fps) add("--query-times", options.ground_truth_flags.options.query.times);
  if (options.selection.recorded_fps)
    add("--recorded-fps", fmt::format("{:g}", *options.selection.recorded_fps));
  const std::string& config = options.save_config.empty() ? common.config : options.save_config;
  add("--config", config);
  if (options.save_config.empty())
    for (const std::string& flag : setting_flags(settings)) words.push_back(flag);
  words.emplace_back("-o result.json");
  return wrapped_command(words);
}

}  // namespace vpr
