// vpr-tune: which window, which threshold? Whole grids for little more than one query.
#include <fmt/format.h>

#include "base/stopwatch.h"
#include "command.h"
#include "images/dataset.h"
#include "number_lists.h"
#include "pipeline/sweep.h"
#include "pipeline/train.h"
#include "recognition/automatic_threshold.h"
#include "report/evaluation_report.h"
#include "report/png_file.h"
#include "report/run_info.h"

namespace vpr {
namespace {

struct TuneInputs {
  std::string database;
  std::string query;
  std::string ground_truth;
  int tolerance_frames = -1;  ///< below 0: the data set's, or 0
  std::vector<std::string> datasets;
  std::string windows;     ///< c_l or c_w
  std::string thresholds;  ///< t_r or t_p
  std::string validate;
  std::string validate_ground_truth;
  std::string plots;
  std::string heat_map;
  TableFormat format = TableFormat::text;
};

/// A query and what it is judged by.
struct Source {
  NamedSequence sequence;
  GroundTruthArgument ground_truth;
};

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
  }
  if (!sources.empty()) return sources;
  if (inputs.query.empty() || inputs.ground_truth.empty())
    throw Error(ErrorKind::usage,
                "give --query and --ground-truth, or data sets that have both (--dataset)");
  const SequenceArgument argument = parse_sequence_argument(inputs.query);
  sources.push_back(
      {{sequence_names({argument}).front(), argument},
       parse_ground_truth_argument(inputs.ground_truth, std::max(inputs.tolerance_frames, 0))});
  return sources;
}

std::optional<Source> find_validation(const TuneInputs& inputs, const std::vector<Source>& sources,
                                      const Monitor& monitor) {
  if (inputs.validate.empty() != inputs.validate_ground_truth.empty())
    throw Error(ErrorKind::usage, "give both --validate and --validate-ground-truth, or neither");
  if (inputs.validate.empty()) return std::nullopt;
  const SequenceArgument argument = parse_sequence_argument(inputs.validate);
  for (const Source& source : sources)
    if (source.sequence.sequence.path == argument.path)
      warn(monitor, fmt::format("{}: is also what the setting is chosen on; a validation needs "
                                "frames that were not seen",
                                argument.path.string()));
  return Source{{sequence_names({argument}).front(), argument},
                parse_ground_truth_argument(inputs.validate_ground_truth,
                                            std::max(inputs.tolerance_frames, 0))};
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
  if (!inputs.heat_map.empty()) check_output_file(inputs.heat_map, options.existing());
  if (!inputs.plots.empty()) check_output_folder(inputs.plots, options.existing(), is_plot_folder);
}

/// Writes pictures, plots and JSON, and prints the table.
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
    picture.emplace(write_png(inputs.heat_map, draw_sweep(sweeps.front()), options.existing()));
  if (!inputs.plots.empty() && !can_draw_plots()) {
    warn(session.monitor, "gnuplot is not installed, so no plots are drawn");
  } else if (!inputs.plots.empty()) {
    OutputFolder folder(inputs.plots, options.existing(), is_plot_folder);
    for (const Sweep& sweep : sweeps) {
      Plot plot = sweep_plot(sweep);
      if (sweeps.size() > 1) plot.file += "-" + sweep.query_name;
      draw_plot(plot, folder.temporary());
    }
    folder.commit();
  }
  if (picture) picture->commit();
  if (!options.output.empty()) write_file(options.output, to_text(json), options.existing());
  std::string text;
  for (const Sweep& sweep : sweeps) {
    text += render_table(sweep_table(sweep), inputs.format);
    if (inputs.format == TableFormat::csv) continue;
    text += recommendation_text(sweep);
    if (sweep.validation)
      text += fmt::format("On {}: {}\n", (*sweep.validation)["query"].get<std::string>(),
                          (*sweep.validation)["counts"].dump());
  }
  session.print_result(text, json);
}

template <class Cell>
Recommendation recommend_cell(const std::vector<Cell>& cells) {
  std::vector<SweepScore> scores;
  for (const Cell& cell : cells) scores.push_back(score_of(cell));
  return recommend(scores);
}

/// What vpr-tune fastable sets beside the grid.
struct FastableTune {
  TuneInputs inputs;
  SequenceQuerySettings settings;
};

SequenceGrid sequence_grid(const TuneInputs& inputs) {
  SequenceGrid grid;
  grid.window_lengths = parse_counts(inputs.windows, "--c-l");
  std::string numbers = inputs.thresholds;
  const size_t automatic = numbers.find("auto");
  const bool has_auto = automatic != std::string::npos;
  if (has_auto) {
    const size_t comma = automatic > 0 ? automatic - 1 : automatic;
    numbers.erase(comma, automatic + 4 - comma + (automatic == 0 && numbers.size() > 4 ? 1 : 0));
  }
  if (!numbers.empty())
    for (const double number : parse_numbers(numbers, "--t-r"))
      grid.distance_thresholds.emplace_back(number);
  if (has_auto) grid.distance_thresholds.emplace_back(std::nullopt);
  return grid;
}

SequenceQuerySettings settings_of(const SequenceQuerySettings& base,
                                  const SequenceCellCounts& cell) {
  SequenceQuerySettings settings = base;
  settings.window_length = cell.window_length;
  settings.distance_threshold = cell.distance_threshold;
  return settings;
}

void tune_fastable(Session& session, const FastableTune& command) {
  const TuneInputs& inputs = command.inputs;
  check_outputs(inputs, session.options);
  const Stopwatch watch;
  const SequenceGrid grid = sequence_grid(inputs);
  const std::vector<Source> sources = find_sources(inputs, false);
  const auto validation = find_validation(inputs, sources, session.monitor);
  const SequenceDatabase database = read_sequence_database(inputs.database);
  QueryResources resources;
  resources.kernels = session.kernels;
  resources.seed = session.options.seed;
  const auto unreadable = command.settings.skip_unreadable ? Unreadable::skip : Unreadable::fail;
  const auto describe = [&](const Source& source) {
    return describe_sequence(open_sequence(source.sequence.sequence), database.descriptor,
                             unreadable, session.monitor);
  };
  std::vector<Sweep> sweeps;
  for (const Source& source : sources) {
    Sweep& sweep = sweeps.emplace_back();
    sweep.query_name = source.sequence.name;
    const SequenceCodes query = describe(source);
    const TruthReader reader = reader_of(source.ground_truth, sweep.protocol);
    sweep.sequence_cells = sweep_sequences(database, query, sweep.query_name, command.settings,
                                           grid, reader, resources, session.monitor);
    sweep.recommendation = recommend_cell(sweep.sequence_cells);
    if (!sweep.recommendation.cell) continue;
    const SequenceCellCounts& chosen = sweep.sequence_cells[*sweep.recommendation.cell];
    sweep.intervals = sequence_intervals(database, query, settings_of(command.settings, chosen),
                                         reader, resources, session.monitor);
    if (!validation) continue;
    std::string protocol;
    const auto cells =
        sweep_sequences(database, describe(*validation), validation->sequence.name,
                        command.settings, {{chosen.window_length}, {chosen.distance_threshold}},
                        reader_of(validation->ground_truth, protocol), resources, session.monitor);
    Sweep elsewhere;
    elsewhere.sequence_cells = cells;
    elsewhere.query_name = validation->sequence.name;
    Json json;
    add_sweeps(json, {elsewhere});
    sweep.validation = json["cells"][0];
  }
  Json settings = value_to_json(command.settings);
  for (const char* key : {"c_l", "t_r"}) settings.erase(key);
  present(session, inputs, sweeps, "fastable", settings, watch.elapsed_s());
}

struct FabmapTune {
  TuneInputs inputs;
  FabmapQuerySettings settings;
};

void tune_fabmap(Session& session, const FabmapTune& command) {
  const TuneInputs& inputs = command.inputs;
  check_outputs(inputs, session.options);
  const Stopwatch watch;
  const FabmapGrid grid{parse_counts(inputs.windows, "--c-w"),
                        parse_numbers(inputs.thresholds, "--t-p")};
  const std::vector<Source> sources = find_sources(inputs, true);
  const auto validation = find_validation(inputs, sources, session.monitor);
  const FabmapDatabase database = read_fabmap_database(inputs.database);
  const auto run = [&](const Source& source, const FabmapGrid& cells, std::string& protocol) {
    const SequenceWords query = describe_words(open_sequence(source.sequence.sequence), database,
                                               command.settings.skip_unreadable, session.monitor);
    return sweep_fabmap(database, query, source.sequence.name, command.settings, cells,
                        reader_of(source.ground_truth, protocol), session.options.seed,
                        session.monitor);
  };
  std::vector<Sweep> sweeps;
  for (const Source& source : sources) {
    Sweep& sweep = sweeps.emplace_back();
    sweep.query_name = source.sequence.name;
    sweep.fabmap_cells = run(source, grid, sweep.protocol);
    sweep.recommendation = recommend_cell(sweep.fabmap_cells);
    if (!sweep.recommendation.cell || !validation) continue;
    const FabmapCellCounts& chosen = sweep.fabmap_cells[*sweep.recommendation.cell];
    Sweep elsewhere;
    elsewhere.query_name = validation->sequence.name;
    elsewhere.fabmap_cells =
        run(*validation, {{chosen.window}, {chosen.place_threshold}}, elsewhere.protocol);
    Json json;
    add_sweeps(json, {elsewhere});
    sweep.validation = json["cells"][0];
  }
  Json settings = value_to_json(command.settings);
  for (const char* key : {"c_w", "t_p"}) settings.erase(key);
  present(session, inputs, sweeps, "fabmap", settings, watch.elapsed_s());
}

struct ThresholdTune {
  std::string database;
  std::string windows = "40";
  double safety_factor = 1;
  bool write = false;
  TableFormat format = TableFormat::text;
};

template <class Visitor>
void visit_fields(ThresholdTune& settings, Visitor&& visit) {
  visit("safety_factor", settings.safety_factor);
}

std::string frame_span(const TrainSequence& sequence, size_t window, size_t length) {
  const std::string& first = sequence.frame_names[window];
  const std::string& last = sequence.frame_names[window + length - 1];
  return fmt::format("{}: {} to {}", sequence.name, first, last);
}

void tune_threshold(Session& session, const ThresholdTune& command) {
  check_safety_factor(command.safety_factor);
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

void add_tune_inputs(CLI::App& command, TuneInputs& inputs) {
  command.add_option("DB", inputs.database, "database made by vpr-train")->required();
  command.add_option("--query", inputs.query, "query sequence, or with --dataset the name of one");
  command.add_option("--ground-truth", inputs.ground_truth, "pairs file, or the word aligned");
  add_setting(command, "--tolerance", inputs.tolerance_frames, "of the ground truth, in frames")
      ->check(CLI::NonNegativeNumber);
  add_list(command, "--dataset", inputs.datasets,
           "data set description with query and ground truth; repeatable");
  command.add_option("--validate", inputs.validate,
                     "another query, on which the recommended setting is reported");
  command.add_option("--validate-ground-truth", inputs.validate_ground_truth, "its ground truth");
  command.add_option("--heat-map", inputs.heat_map,
                     "picture (PNG) of correct and incorrect over the grid");
  command.add_option("--plot", inputs.plots, "folder for plots of correct against incorrect");
  add_setting(command, "--format", inputs.format,
              "of the table: text (default), csv, markdown or latex");
}

void add_fastable(Program& program, FastableTune& tune) {
  CLI::App& command = program.add_command(
      "fastable", "All window lengths and thresholds of FastABLE in one pass.",
      "  vpr-tune fastable corridor.vprdb --query corridor/query --ground-truth pairs.csv "
      "--c-l 2,5,10,20,40 --t-r 0.2:0.7:0.05 -o sweep.json",
      [&tune](Session& session) { tune_fastable(session, tune); });
  program.add_config(command, tune.settings);
  add_tune_inputs(command, tune.inputs);
  command.add_option("--c-l", tune.inputs.windows, "window lengths, as in 2,5,10 or 10:50:10")
      ->required();
  command
      .add_option("--t-r", tune.inputs.thresholds,
                  "thresholds, as in 0.2:0.6:0.05; the word auto may be one of them")
      ->required();
  add_setting(command, "--t-r-scale", tune.settings.threshold_scale,
              "of the numbers: relative (default) or bits");
  command.add_flag("--skip-unreadable", tune.settings.skip_unreadable,
                   "frames that can't be decoded keep their index and never match");
}

void add_fabmap(Program& program, FabmapTune& tune) {
  CLI::App& command = program.add_command(
      "fabmap", "All windows and thresholds of FAB-MAP from one pass of posteriors.",
      "  vpr-tune fabmap places.vprdb --query walk --ground-truth places.csv --c-w 1,3,5,8 "
      "--t-p 0.6,0.99 -o sweep.json",
      [&tune](Session& session) { tune_fabmap(session, tune); });
  program.add_config(command, tune.settings);
  add_tune_inputs(command, tune.inputs);
  command.add_option("--c-w", tune.inputs.windows, "windows, as in 1,3,5,8")->required();
  command.add_option("--t-p", tune.inputs.thresholds, "thresholds, as in 0.5:0.95:0.05,0.99")
      ->required();
  command.add_flag("--skip-unreadable", tune.settings.skip_unreadable,
                   "frames that can't be decoded keep their index and show no words");
}

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

}  // namespace
}  // namespace vpr

int main(int argc, char** argv) {
  using namespace vpr;
  Program program("vpr-tune", "Choose window lengths and thresholds: whole grids in one pass.",
                  "  vpr-tune fastable corridor.vprdb --query corridor/query --ground-truth "
                  "aligned --tolerance 3 --c-l 5,10,20 --t-r 0.3:0.7:0.1 -o sweep.json");
  FastableTune fastable;
  add_fastable(program, fastable);
  FabmapTune fabmap;
  add_fabmap(program, fabmap);
  ThresholdTune threshold;
  add_threshold(program, threshold);
  return program.main(argc, argv);
}
