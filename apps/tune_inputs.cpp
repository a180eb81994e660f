#include "tune_inputs.h"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"
#include "report/png_file.h"
#include "report/run_info.h"

namespace vpr {

std::vector<Source> find_sources(const TuneInputs& inputs, bool is_fabmap) {
  std::vector<Source> sources;
  for (const std::string& path : inputs.datasets) {
    const Dataset dataset = read_dataset(path);
    const DatasetQuery& query =
        select_query(dataset, inputs.query.empty() ? std::nullopt : std::optional(inputs.query));
    const auto& truth = is_fabmap ? query.place_ground_truth : query.sequence_ground_truth;
    if (!truth)
      throw Error(ErrorKind::usage,
                  fmt::format("{}: the query {} has no ground truth", path, query.sequence.name));
    Source& source = sources.emplace_back(Source{query.sequence, *truth});
    if (inputs.tolerance_frames >= 0)
      source.ground_truth.tolerance_frames = inputs.tolerance_frames;
    source.ground_truth = with_flags(source.ground_truth, inputs.flags);
  }
  if (!sources.empty()) return sources;
  if (inputs.query.empty() || inputs.ground_truth.empty())
    throw Error(ErrorKind::usage,
                "give --query and --ground-truth, or data sets that have both (--dataset)");
  const SequenceArgument argument = parse_sequence_argument(inputs.query);
  sources.push_back({{sequence_names({argument}).front(), argument},
                     with_flags(parse_ground_truth_argument(inputs.ground_truth,
                                                            std::max(inputs.tolerance_frames, 0)),
                                inputs.flags)});
  return sources;
}

namespace {

GroundTruthArgument validation_ground_truth(const TuneInputs& inputs) {
  return with_flags(parse_ground_truth_argument(inputs.validate_ground_truth,
                                                std::max(inputs.tolerance_frames, 0)),
                    inputs.flags);
}

bool share_frames(const SequenceArgument& a, const SequenceArgument& b) {
  constexpr uint64_t kEnd = std::numeric_limits<uint64_t>::max();
  return a.path == b.path && a.range.first < b.range.last.value_or(kEnd) &&
         b.range.first < a.range.last.value_or(kEnd);
}

}  // namespace

std::optional<Source> find_validation(const TuneInputs& inputs, const std::vector<Source>& sources,
                                      const Monitor& monitor) {
  if (inputs.validate.empty() != inputs.validate_ground_truth.empty())
    throw Error(ErrorKind::usage, "give both --validate and --validate-ground-truth, or neither");
  if (inputs.validate.empty()) return std::nullopt;
  const SequenceArgument argument = parse_sequence_argument(inputs.validate);
  for (const Source& source : sources)
    if (share_frames(source.sequence.sequence, argument))
      warn(monitor, fmt::format("{}: is also what the setting is chosen on; a validation needs "
                                "frames that were not seen",
                                argument.path.string()));
  return Source{{sequence_names({argument}).front(), argument}, validation_ground_truth(inputs)};
}

TruthReader reader_of(const GroundTruthArgument& argument, std::string& protocol) {
  return [argument, &protocol](const GroundTruthScope& scope) {
    GroundTruth truth = read_ground_truth(argument, scope);
    protocol = truth.protocol;
    return truth;
  };
}

void check_outputs(const TuneInputs& inputs, const CommonOptions& options) {
  if (options.output.empty() && !options.json)
    throw Error(ErrorKind::usage, "give the sweep to write, as in -o SWEEP.json, or --json");
  if (!options.output.empty()) check_output_file(options.output, options.existing());
  if (!inputs.heat_map.empty() && inputs.heat_map == options.output)
    throw Error(ErrorKind::usage,
                fmt::format("{}: is written twice; give --heat-map another name", options.output));
  if (!inputs.heat_map.empty()) check_output_file(inputs.heat_map, options.existing());
  if (!inputs.plots.empty()) check_output_folder(inputs.plots, options.existing(), is_plot_folder);
}

Json sweep_key(const TuneInputs& inputs, const Json& settings, const std::string& fingerprint,
               uint64_t seed) {
  return {{"settings", settings},
          {"windows", inputs.windows},
          {"thresholds", inputs.thresholds},
          {"datasets", inputs.datasets},
          {"query", inputs.query},
          {"tolerance", inputs.tolerance_frames},
          {"ground_truth", ground_truth_flags_json(inputs.flags)},
          {"validate", inputs.validate},
          {"validate_ground_truth", inputs.validate_ground_truth},
          {"database", fingerprint},
          {"seed", seed}};
}

PartialSweeps::PartialSweeps(const TuneInputs& inputs, const CommonOptions& options,
                             const Json& key)
    : key_(key) {
  if (options.output.empty() || inputs.datasets.size() < 2) return;
  path_ = options.output + ".partial";
  if (!inputs.resume || !std::filesystem::exists(path_)) return;
  const Json json = read_json(path_, ErrorKind::data);
  require_schema(json, "sweep-partial", path_, ErrorKind::data);
  if (!json.contains("key") || json["key"] != key_)
    throw Error(ErrorKind::usage,
                fmt::format("{}: was made with other settings or data; leave out --resume to start "
                            "again",
                            path_));
  finished_ = read_sweeps(json, path_);
}

void PartialSweeps::add(const Sweep& sweep) {
  finished_.push_back(sweep);
  if (path_.empty()) return;
  Json json = {{"schema", "vpr.sweep-partial/1"}, {"key", key_}};
  add_sweeps(json, finished_);
  write_file(path_, to_text(json), Existing::replace);
}

void PartialSweeps::remove() {
  std::error_code ignored;
  if (!path_.empty()) std::filesystem::remove(path_, ignored);
}

void present(Session& session, const TuneInputs& inputs, const std::vector<Sweep>& sweeps,
             const std::string& method, const Json& settings, double seconds) {
  const CommonOptions& options = session.options;
  Json json = {{"schema", "vpr.sweep/1"}, {"method", method}, {"settings", settings}};
  add_sweeps(json, sweeps);
  json["provenance"] = provenance_json(session.run);
  session.run.simd_target = session.kernels.target;
  session.run.paths = {{"database", inputs.database}};
  json["machine"] = machine_json(session.run);
  json["timing"] = timing_json({{"sweep", seconds}});
  std::optional<OutputFile> picture;
  if (!inputs.heat_map.empty())
    picture.emplace(write_png(inputs.heat_map, draw_sweeps(sweeps), options.existing()));
  if (picture) picture->commit();
  if (!options.output.empty()) write_file(options.output, to_text(json), options.existing());
  if (!inputs.plots.empty() && !can_draw_plots()) {
    warn(session.monitor, "gnuplot is not installed, so no plots are drawn");
  } else if (!inputs.plots.empty()) {
    OutputFolder folder(inputs.plots, options.existing(), is_plot_folder);
    for (size_t s = 0; s < sweeps.size(); ++s) {
      Plot plot = sweep_plot(sweeps[s]);
      if (sweeps.size() > 1) plot.file += fmt::format("-{}", s + 1);
      draw_plot(plot, folder.temporary());
    }
    folder.commit();
  }
  std::string text = render_table(sweep_table(sweeps), inputs.format);
  for (const Sweep& sweep : sweeps) {
    if (inputs.format == TableFormat::csv) break;
    text += recommendation_text(sweep);
    if (sweep.validation)
      text += fmt::format("On {}: {}\n", (*sweep.validation)["query"].get<std::string>(),
                          (*sweep.validation)["counts"].dump());
  }
  session.print_result(text, json);
}

void add_tune_inputs(const Command& command, TuneInputs& inputs) {
  command.add_option("DB", inputs.database, "database made by vpr-train").required();
  command.add_option("--query", inputs.query, "query sequence, or with --dataset the name of one");
  command.add_option("--ground-truth", inputs.ground_truth, ground_truth_help());
  add_setting(command, "--tolerance", inputs.tolerance_frames, "of the ground truth, in frames")
      .non_negative();
  command.add_list("--dataset", inputs.datasets,
                   "data set description with query and ground truth; repeatable");
  command.add_flag("--resume", inputs.resume,
                   "with several data sets: go on behind those that an interrupted sweep finished "
                   "(kept in SWEEP.json.partial)");
  command.add_option("--validate", inputs.validate,
                     "another query, on which the recommended setting is reported");
  command.add_option("--validate-ground-truth", inputs.validate_ground_truth,
                     "its ground truth, read like the other");
  add_ground_truth_flags(command, inputs.flags);
  command.add_option("--heat-map", inputs.heat_map,
                     "picture (PNG) of correct and incorrect over the grid");
  command.add_option("--plot", inputs.plots, "folder for plots of correct against incorrect");
  add_setting(command, "--format", inputs.format,
              "of the table: text (default), csv, markdown or latex");
}

}  // namespace vpr
