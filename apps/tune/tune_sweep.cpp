// vpr-tune fastable and vpr-tune fabmap: sweeps over windows and thresholds.
#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "present/tuning_report.h"
#include "run/advice.h"
#include "run/plan.h"
#include "run/train.h"
#include "sequence/sequence_source.h"
#include "tune.h"

namespace vpr {
namespace {

Source make_source(const TuneOptions& options, NamedSequence sequence, GroundTruthArgument truth,
                   const Dataset* dataset, const Session& session) {
  sequence.sequence =
      selected(sequence.sequence, options.selection, truth.options.query_times, dataset, session);
  remove_selection_times(truth, options.selection);
  return {sequence, truth};
}

Source find_in_dataset(const TuneOptions& options, const std::string& path, const std::string& name,
                       DatabaseFamily family, const Session& session) {
  const Dataset dataset = read_dataset(path);
  const DatasetQuery& query =
      select_query(dataset, name.empty() ? std::nullopt : std::optional(name));
  const auto truth = ground_truth_of(query, family, options.ground_truth_flags);
  if (!truth)
    throw Error(ErrorKind::usage,
                fmt::format("{}: the query {} has no ground truth", path, query.sequence.name));
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

// The recommended settings as flags of vpr-query, except defaults and those of a configuration
// file.
std::vector<std::string> setting_flags(const QuerySettings& recommended) {
  const Json settings = settings_in_force(recommended);
  std::vector<std::string> flags;
  for (const auto& [key, flag] :
       {std::pair("c_l", "--c-l"), std::pair("t_r", "--t-r"), std::pair("decide", "--decide"),
        std::pair("margin", "--margin"), std::pair("exclusion_frames", "--exclusion-frames"),
        std::pair("c_w", "--c-w"), std::pair("t_p", "--t-p"), std::pair("score", "--score"),
        std::pair("fusion_weight", "--fusion-weight")})
    if (settings.contains(key)) {
      const Json& value = settings[key];
      const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
      flags.push_back(fmt::format("{}{}{}", flag, text.starts_with('-') ? "=" : " ", text));
    }
  if (settings.value("t_r_scale", "") == enum_name(ThresholdScale::bits))
    flags.emplace_back("--t-r-scale bits");
  if (settings.value("skip_unreadable", false)) flags.emplace_back("--skip-unreadable");
  return flags;
}

// vpr-query with the recommended settings, on the query of the sweep.
std::string query_command(const TuneOptions& options, const CommonOptions& common,
                          const Sweep& sweep, size_t index) {
  std::vector<std::string> words = {"vpr-query", shell_word(options.database)};
  if (!options.datasets.empty()) {
    words.push_back("--dataset " + shell_word(options.datasets[index]));
    if (!options.query.empty()) words.push_back("--query " + shell_word(options.query));
  } else {
    words.push_back("--query " + shell_word(options.query));
  }
  if (!options.fuse.empty()) words.push_back("--fuse " + shell_word(options.fuse));
  const std::string& config = options.save_config.empty() ? common.config : options.save_config;
  if (!config.empty()) words.push_back("--config " + shell_word(config));
  if (options.save_config.empty())
    for (const std::string& flag : setting_flags(*sweep.recommended_settings))
      words.push_back(flag);
  return fmt::format("{}", fmt::join(words, " "));
}

std::string result_text(const TuneOptions& options, const CommonOptions& common,
                        const std::vector<Sweep>& sweeps) {
  if (options.format == TableFormat::csv)
    return render_table(cells_table(sweeps), TableFormat::csv);
  std::string text;
  for (const Table& table : sweep_tables(sweeps))
    text += render_table(table, options.format) + "\n";
  for (size_t s = 0; s < sweeps.size(); ++s) {
    text += recommendation_text(sweeps[s]);
    if (!sweeps[s].recommendation.cell) continue;
    if (sweeps[s].validation) text += validation_text(*sweeps[s].validation);
    text += fmt::format("  {} -o result.json\n", query_command(options, common, sweeps[s], s));
  }
  return text;
}

void draw_plots(Session& session, const TuneOptions& options, const std::vector<Sweep>& sweeps) {
  const Output& folder = session.outputs.folder(options.plots, is_marked_folder);
  for (size_t s = 0; s < sweeps.size(); ++s) {
    Chart chart = sweep_chart(sweeps[s]);
    if (sweeps.size() > 1) chart.file += fmt::format("-{}", s + 1);
    draw_chart(chart, folder.temporary());
  }
}

/// The part that differs between the families: describes a query and sweeps it, over `grid`, or
/// over the grid of the flags if it is null.
using SweepQuery =
    std::function<Sweep(const Source& source, const Grid* grid, const TruthReader& reader)>;

// Sweeps all queries over the grid of the first, and the recommended cell of each on the
// validation. `database`: as in reader_of.
std::vector<Sweep> sweep_all(const std::vector<Source>& queries,
                             const std::optional<Source>& validation,
                             const SequenceDatabase* database, const SweepQuery& sweep,
                             const Monitor& monitor) {
  std::vector<Sweep> sweeps;
  std::optional<Grid> grid;
  for (const Source& query : queries) {
    Sweep& found = sweeps.emplace_back(
        sweep(query, grid ? &*grid : nullptr, reader_of(query, database, monitor)));
    grid = grid_of(found.cells);
    const auto& recommended = found.recommendation.cell;
    if (!recommended || !validation) continue;
    const Grid one = grid_of({&found.cells[*recommended], 1});
    found.validation = {
        validation->sequence.name,
        sweep(*validation, &one, reader_of(*validation, database, monitor)).cells.front()};
  }
  return sweeps;
}

void claim_outputs(const TuneOptions& options, const Session& session) {
  for (const std::string& file : {session.options.output, options.heat_map, options.save_config})
    if (!file.empty()) session.outputs.claim_file(file);
  if (!options.plots.empty()) session.outputs.claim_folder(options.plots, is_marked_folder);
  if (!options.save_config.empty() && options.datasets.size() > 1)
    throw Error(ErrorKind::usage,
                fmt::format("--save-config writes one recommendation, but each of {} data sets has "
                            "its own; sweep them one by one",
                            options.datasets.size()));
}

// Writes and prints all outputs. `base`: the settings, two of which the sweeps vary. At the end
// throws Error(expectation) if --save-config has no recommendation.
void present(Session& session, const TuneOptions& options, DatabaseFamily family,
             const QuerySettings& base, const std::vector<Sweep>& sweeps, double seconds) {
  session.run.simd_target = session.kernels.target;
  session.run.paths = {{"database", options.database}};
  const Json json = sweep_json(enum_name(family), base, sweeps, session.run, seconds);
  const std::optional<QuerySettings>& recommended = sweeps.front().recommended_settings;
  session.write_output(json);
  if (!options.heat_map.empty()) session.outputs.file(options.heat_map).write(heat_map_png(sweeps));
  if (!options.save_config.empty() && recommended)
    session.outputs.file(options.save_config).write(config_text(*recommended));
  if (!options.plots.empty()) draw_plots(session, options, sweeps);
  session.print_result(result_text(options, session.options, sweeps), json);
  if (!options.save_config.empty() && !recommended)
    throw Error(ErrorKind::expectation,
                fmt::format("{}: is not written, because no setting is recommended: {}",
                            options.save_config, reason_text(sweeps.front())));
}

void tune_fastable(Session& session, const TuneOptions& options,
                   const SequenceQuerySettings& base) {
  const Monitor& monitor = session.monitor;
  RunChoices run = {kDatabaseChoice, kSweepChoice};
  if (!options.fuse.empty()) run.emplace_back("--fuse");
  if (!options.grid.thresholds.empty()) run.emplace_back("--t-r");
  if (!options.grid.margins.empty()) run.emplace_back("--margin");
  const ResolvedSettings settings(base, run);
  claim_outputs(options, session);
  const std::vector<Source> queries = find_queries(options, DatabaseFamily::sequences, session);
  const auto validation = find_validation(options, DatabaseFamily::sequences, queries, session);
  SequenceDatabase database = open_database(options.database, settings, options.fuse, monitor);
  const QueryResources resources{session.kernels, options.memory_limit, 0, session.options.seed};
  session.run.memory_limit = options.memory_limit;
  const Stopwatch watch;
  const auto sweep = [&](const Source& source, const Grid* grid, const TruthReader& reader) {
    const DescriptorSet query =
        describe_query(source.sequence.sequence, database, settings, monitor);
    Sweep found = sweep_sequences(
        database, query, source.sequence.name, settings,
        grid != nullptr ? *grid : sequence_grid(options.grid, *settings, database, query), reader,
        resources, monitor);
    if (!found.recommendation.cell) {
      ensure_statistics(database, monitor);
      warn(monitor, filter_advice(database, query, *settings, resources, monitor));
    }
    return found;
  };
  const std::vector<Sweep> sweeps = sweep_all(queries, validation, &database, sweep, monitor);
  present(session, options, DatabaseFamily::sequences, *settings, sweeps, watch.elapsed_s());
}

void tune_fabmap(Session& session, const TuneOptions& options,
                 const FabmapQuerySettings& settings) {
  const Monitor& monitor = session.monitor;
  claim_outputs(options, session);
  const std::vector<Source> queries = find_queries(options, DatabaseFamily::fabmap, session);
  const auto validation = find_validation(options, DatabaseFamily::fabmap, queries, session);
  const FabmapDatabase database = read_fabmap_database(options.database);
  const Stopwatch watch;
  const auto sweep = [&](const Source& source, const Grid* grid, const TruthReader& reader) {
    const SequenceWords query = describe_words(open_sequence(source.sequence.sequence), database,
                                               settings.skip_unreadable, monitor);
    return sweep_fabmap(database, query, source.sequence.name, settings,
                        grid != nullptr ? *grid : fabmap_grid(options.grid), reader,
                        session.options.seed, monitor);
  };
  const std::vector<Sweep> sweeps = sweep_all(queries, validation, nullptr, sweep, monitor);
  present(session, options, DatabaseFamily::fabmap, settings, sweeps, watch.elapsed_s());
}

void add_options(const Command& command, TuneOptions& options) {
  command.add_option("DB", options.database, "database of vpr-train").required();
  command.add_option("--query", options.query,
                     "query sequence; with --dataset, the name of one of its queries");
  command.add_option("--ground-truth", options.ground_truth, ground_truth_help());
  command.add_list("--dataset", options.datasets,
                   "data set description with query and ground truth; repeatable");
  command.add_option("--save-config", options.save_config,
                     "write the recommended settings for vpr-query --config; exit code 5 if there "
                     "are none");
  command.add_option("--validate", options.validate,
                     "another query to evaluate the recommended settings on; with one --dataset, "
                     "the name of another of its queries");
  command.add_option("--validate-ground-truth", options.validate_ground_truth,
                     "ground truth of --validate, with the same options");
  add_speed_flag(command, options.selection.speed);
  add_rate_flags(command, options.selection, "queries");
  add_ground_truth_flags(command, options.ground_truth_flags);
  command.add_option("--heat-map", options.heat_map,
                     "image of correct and incorrect recognitions over the grid (PNG)");
  command.add_option("--plot", options.plots,
                     "folder for plots of correct against incorrect recognitions");
  add_format_flag(command, options.format,
                  "format of the tables: text, markdown, latex, or csv with one row per cell "
                  "(default: text)");
}

}  // namespace

std::vector<Source> find_queries(const TuneOptions& options, DatabaseFamily family,
                                 const Session& session) {
  if (!options.selection.speed.empty()) check_speed(options.selection.speed);
  std::vector<Source> queries;
  for (const std::string& path : options.datasets)
    queries.push_back(find_in_dataset(options, path, options.query, family, session));
  if (!queries.empty()) return queries;
  if (options.query.empty() || options.ground_truth.empty())
    throw Error(ErrorKind::usage,
                "the query is missing; pass --query and --ground-truth, or --dataset");
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
           fmt::format("{}: the settings are chosen on frames of the validation; validate on "
                       "frames that were not seen",
                       validation.sequence.sequence.path.string()));
  return validation;
}

TruthReader reader_of(const Source& source, const SequenceDatabase* database,
                      const Monitor& monitor) {
  return [&, database](GroundTruthScope scope) {
    scope.query_names = [&] { return frame_names(source.sequence.sequence); };
    if (database != nullptr)
      for (size_t s = 0; s < scope.sequences.size(); ++s)
        scope.sequences[s].names = [database, s] {
          return database->sequences[s].sequence.frame_names;
        };
    return read_ground_truth(source.ground_truth, scope, monitor);
  };
}

void add_fastable(Program& program) {
  struct Fastable {
    TuneOptions options;
    SequenceQuerySettings settings;
  };
  const auto tune = std::make_shared<Fastable>();
  const Command command = program.add_command(
      "fastable", "Evaluate all window lengths and thresholds of FastABLE in one pass.",
      "  vpr-tune fastable corridor.vprdb --query corridor/query --ground-truth pairs.csv\n"
      "  vpr-tune fastable corridor.vprdb --query corridor/query --ground-truth pairs.csv "
      "--c-l 2,5,10,20,40 --t-r 0.2:0.7:0.05 --save-config best.json -o sweep.json\n"
      "  vpr-tune fastable corridor.vprdb --query corridor/query --ground-truth pairs.csv "
      "--score zscore --decide margin --margin 0.2:1:0.1",
      [tune](Session& session) { tune_fastable(session, tune->options, tune->settings); });
  program.add_config(command, tune->settings);
  add_options(command, tune->options);
  add_sequence_grid(command, tune->options.grid);
  add_score_settings(command, tune->settings);
  add_rate_settings(command, tune->settings);
  add_decision_settings(command, tune->settings);
  add_fusion_settings(command, tune->settings, tune->options.fuse);
  add_unreadable_flag(command, tune->settings.skip_unreadable);
  add_memory_flag(command, tune->options.memory_limit,
                  "memory for rings and recognitions of all c_l in bytes, as in 512M");
}

void add_fabmap(Program& program) {
  struct Fabmap {
    TuneOptions options;
    FabmapQuerySettings settings;
  };
  const auto tune = std::make_shared<Fabmap>();
  const Command command = program.add_command(
      "fabmap", "Evaluate all windows and thresholds of FAB-MAP in one pass.",
      "  vpr-tune fabmap places.vprdb --query walk --ground-truth places.csv --c-w 1,3,5,8 "
      "--t-p 0.6,0.9,0.99 --save-config best.json -o sweep.json",
      [tune](Session& session) { tune_fabmap(session, tune->options, tune->settings); });
  program.add_config(command, tune->settings);
  add_options(command, tune->options);
  add_fabmap_grid(command, tune->options.grid);
  add_unreadable_flag(command, tune->settings.skip_unreadable);
}

}  // namespace vpr
