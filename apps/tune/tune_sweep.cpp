// vpr-tune fastable and vpr-tune fabmap: sweeps over windows and thresholds, and their grids: lists
// of values on the command line, or defaults.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "query/advice.h"
#include "query/choices.h"
#include "query/open.h"
#include "query/prepare.h"
#include "tune.h"
#include "tune/sweep_report.h"
#include "tune/trials.h"

namespace vpr {
namespace {

constexpr const char* kValidationGroup = "Validation";
constexpr const char* kOutputGroup = "Outputs";

constexpr double kMostValues = 10'000;
constexpr const char* kWindowLengths = "5,10,20,40,80";
constexpr const char* kFabmapWindows = "1,2,3,5,8";
constexpr const char* kPlaceThresholds = "0.3:0.9:0.1,0.95,0.99,0.999";
// By ThresholdScale: relative, bits, mean-z.
constexpr std::array<const char*, 3> kDistanceThresholds = {"0.3:0.9:0.025", "100:490:15",
                                                            "-4:-0.5:0.125"};
constexpr const char* kDistanceMargins = "4:80:4,auto";
constexpr const char* kScoreMargins = "0.1:1.5:0.1,auto";

std::string value_or(const std::string& given, const char* standard) {
  return given.empty() ? standard : given;
}

double parse_number(std::string_view text, const std::string& flag) {
  const Json value = flag_value(std::string(text));
  if (!value.is_number())
    throw Error(ErrorKind::usage,
                "{} takes numbers, lists or ranges, as in 2,5,10 or 0.2:0.6:0.05, found \"{}\"",
                flag, text);
  return value.get<double>();
}

// A number or a range.
std::vector<double> parse_part(std::string_view part, const std::string& flag) {
  const auto range = split(part, ':');
  if (range.size() == 1) return {parse_number(part, flag)};
  const double first = parse_number(range[0], flag);
  const double last = parse_number(range[1], flag);
  const double step = range.size() > 2 ? parse_number(range[2], flag) : 1;
  const double count = std::floor((last - first) / step + 1e-9);
  if (range.size() > 3 || !(step > 0) || !(last >= first) || count >= kMostValues)
    throw Error(ErrorKind::usage,
                "{}: a range is FIRST:LAST:STEP with at most {:.0f} values, found \"{}\"", flag,
                kMostValues, part);
  std::vector<double> numbers;
  for (int i = 0; i <= count; ++i) numbers.push_back(std::round((first + i * step) * 1e9) / 1e9);
  return numbers;
}

// Parses "2,5,10", "0.2:0.6:0.05" (with both ends if the steps reach them), "1:5" (in steps of 1),
// or a mixture, without duplicates. Values of a range are rounded to nine decimals. "auto", if
// allowed, is nullopt. Throws Error(usage), which names the flag.
std::vector<std::optional<double>> parse_values(const std::string& text, const std::string& flag,
                                                bool allow_auto) {
  std::vector<std::optional<double>> values;
  const auto add_once = [&](std::optional<double> value) {
    if (std::ranges::find(values, value) == values.end()) values.push_back(value);
  };
  for (const std::string_view part : split(text, ',')) {
    if (allow_auto && part == "auto")
      add_once(std::nullopt);
    else
      for (const double number : parse_part(part, flag)) add_once(number);
  }
  return values;
}

// The given window lengths, or the default ones with a window in the query and in a training
// sequence; the shortest if there are none.
std::vector<uint64_t> window_lengths(const std::string& given, const SequenceDatabase& database,
                                     const DescriptorSet& query) {
  std::vector<uint64_t> lengths = parse_counts(value_or(given, kWindowLengths), "--c-l");
  if (!given.empty()) return lengths;
  const std::vector<uint64_t> fitting = fitting_lengths(lengths, database, {&query});
  return fitting.empty() ? std::vector{lengths.front()} : fitting;
}

// The grid of the flags. Default c_l are those that fit the query and a training sequence; default
// t_r or margins cover the scale of the settings. Throws Error(usage) for an invalid list.
Grid sequence_grid(const GridFlags& flags, const SequenceQuerySettings& settings,
                   const SequenceDatabase& database, const DescriptorSet& query) {
  const std::vector<uint64_t> lengths = window_lengths(flags.windows, database, query);
  if (const auto scale = scale_of(settings)) {
    const char* thresholds = kDistanceThresholds[static_cast<size_t>(*scale)];
    return {lengths, parse_values(value_or(flags.thresholds, thresholds), "--t-r", true)};
  }
  const char* margins = is_zscore(settings.rule) ? kScoreMargins : kDistanceMargins;
  return {lengths, parse_values(value_or(flags.margins, margins), "--margin", true)};
}

Grid fabmap_grid(const GridFlags& flags) {
  return {parse_counts(value_or(flags.windows, kFabmapWindows), "--c-w"),
          parse_values(value_or(flags.thresholds, kPlaceThresholds), "--t-p", false)};
}

template <class Settings>
struct SweepCommand {
  TuneOptions options;
  Settings settings;
};

std::string sweep_text(const TuneOptions& options, const CommonOptions& common,
                       const std::vector<Sweep>& sweeps) {
  if (options.format == TableFormat::csv)
    return render_table(cells_table(sweeps), TableFormat::csv);
  std::string text;
  if (common.verbose || options.format != TableFormat::text)
    for (const Table& table : sweep_tables(sweeps))
      text += render_table(table, options.format) + "\n";
  for (size_t s = 0; s < sweeps.size(); ++s) {
    if (options.format == TableFormat::text)
      text += render_table(best_cells_table(sweeps[s]), options.format);
    text += recommendation_text(sweeps[s], common.verbose);
    if (!sweeps[s].recommendation.cell && !options.validate.empty())
      text += "Nothing is validated.\n";
    if (!sweeps[s].recommendation.cell) continue;
    if (sweeps[s].validation) text += validation_text(sweeps[s]);
    text += query_command(options, common, *sweeps[s].recommended_settings, s) + "\n";
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
using SweepQuery = std::function<Sweep(const Source& source, const Grid* grid)>;

// Sweeps all queries over the grid of the first, and the recommended cell of each on the
// validation.
std::vector<Sweep> sweep_all(const std::vector<Source>& queries,
                             const std::optional<Source>& validation, const SweepQuery& sweep) {
  std::vector<Sweep> sweeps;
  std::optional<Grid> grid;
  for (const Source& query : queries) {
    Sweep& found = sweeps.emplace_back(sweep(query, grid ? &*grid : nullptr));
    grid = found.grid;
    const auto& recommended = found.recommendation.cell;
    if (!recommended || !validation) continue;
    const CellCounts& cell = found.cells[*recommended];
    const Grid one = {{cell.window}, {cell.threshold}};
    found.validation = {validation->sequence.name, sweep(*validation, &one).cells.front()};
  }
  return sweeps;
}

void claim_outputs(const TuneOptions& options, const Session& session) {
  session.claim_output({options.heat_map, options.save_config}, options.plots);
  if (!options.save_config.empty() && options.datasets.size() > 1)
    throw Error(ErrorKind::usage,
                "--save-config writes one recommendation, but each of {} data sets has its own; "
                "sweep them one by one",
                options.datasets.size());
}

// Writes and prints all outputs. `base`: the settings, two of which the sweeps vary. At the end
// throws Error(expectation) if --save-config has no recommendation.
void present(Session& session, const TuneOptions& options, DatabaseFamily family,
             const QuerySettings& base, const std::vector<Sweep>& sweeps, double seconds) {
  session.run.paths = {{"database", options.database}};
  const Json json = sweep_json(enum_name(family), base, sweeps, session.run, seconds);
  const std::optional<QuerySettings>& recommended = sweeps.front().recommended_settings;
  session.write_output(json);
  if (!options.heat_map.empty()) session.outputs.file(options.heat_map).write(heat_map_png(sweeps));
  if (!options.save_config.empty() && recommended)
    session.outputs.file(options.save_config).write(config_text(*recommended));
  if (!options.plots.empty()) draw_plots(session, options, sweeps);
  session.print_result(sweep_text(options, session.options, sweeps), json);
  if (!options.save_config.empty() && !recommended)
    throw Error(ErrorKind::expectation, "{}: is not written, because no setting is recommended: {}",
                options.save_config, reason_text(sweeps.front()));
}

void tune_fastable(Session& session, const TuneOptions& options, const SequenceKeys& keys) {
  const Monitor& monitor = session.monitor;
  const SequenceQuerySettings settings =
      choose_query(keys, given_keys<SequenceKeys>(session), QueryCommand::sweep);
  const bool by_margin = std::holds_alternative<Margin>(settings.rule);
  if (by_margin && !options.grid.thresholds.empty()) refuse_setting("t_r", settings.rule);
  if (!by_margin && !options.grid.margins.empty()) refuse_setting("margin", settings.rule);
  claim_outputs(options, session);
  const std::vector<Source> queries = find_queries(options, DatabaseFamily::sequences, session);
  const auto validation = find_validation(options, DatabaseFamily::sequences, queries, session);
  const SequenceQuerySettings filter = default_filter(settings);
  const SequenceDatabase database = open_database(options.database, filter, monitor);
  const QueryResources resources{options.memory_limit, session.options.process.seed};
  session.run.memory_limit = options.memory_limit;
  const Stopwatch watch;
  const auto sweep = [&](const Source& source, const Grid* grid) {
    const std::vector<LabeledQuery> labeled = {
        {source.sequence.name, describe_query(source.sequence.sequence, database, filter, monitor),
         evaluation_of(source, &database)}};
    const LabeledQuery& query = labeled.front();
    warn_of_rates(database, query.frames.sequence.fps, settings, monitor);
    Sweep found = sweep_sequences(
        database, query, settings,
        grid != nullptr ? *grid : sequence_grid(options.grid, settings, database, query.frames),
        resources, monitor);
    const Monitor silent = {monitor.progress, {}, monitor.stop};
    found.filter = try_setting(database, labeled, filter, resources, silent).total().path;
    if (session.prints_text() && found.filter->recognized == 0 && !found.recommendation.cell)
      found.advice = filter_advice(database, query.frames, filter, resources, silent);
    return found;
  };
  const std::vector<Sweep> sweeps = sweep_all(queries, validation, sweep);
  present(session, options, DatabaseFamily::sequences, settings, sweeps, watch.elapsed_s());
}

void tune_fabmap(Session& session, const TuneOptions& options,
                 const FabmapQuerySettings& settings) {
  const Monitor& monitor = session.monitor;
  claim_outputs(options, session);
  const std::vector<Source> queries = find_queries(options, DatabaseFamily::fabmap, session);
  const auto validation = find_validation(options, DatabaseFamily::fabmap, queries, session);
  const FabmapDatabase database = read_fabmap_database(options.database);
  const Stopwatch watch;
  const auto sweep = [&](const Source& source, const Grid* grid) {
    const LabeledWords query = {source.sequence.name,
                                describe_words(open_sequence(source.sequence.sequence), database,
                                               settings.skip_unreadable, monitor),
                                evaluation_of(source, nullptr)};
    return sweep_fabmap(database, query, settings,
                        grid != nullptr ? *grid : fabmap_grid(options.grid),
                        session.options.process.seed, monitor);
  };
  const std::vector<Sweep> sweeps = sweep_all(queries, validation, sweep);
  present(session, options, DatabaseFamily::fabmap, settings, sweeps, watch.elapsed_s());
}

void add_sweep_flags(const Command& command, TuneOptions& options) {
  add_query_flags(command, options).required();
  command.add_option("--save-config", options.save_config,
                     "recommended settings for vpr-query --config; exit code 5 if there are none");
  command.add_option("--validate", options.validate,
                     "another query to evaluate the recommended settings on; with one --dataset, "
                     "the name of another of its queries",
                     kValidationGroup);
  command.add_option("--validate-ground-truth", options.validate_ground_truth,
                     "ground truth of --validate, with the same options", kValidationGroup);
  command.add_option("--heat-map", options.heat_map, "image of the counts over the grid (PNG)");
  command.add_option("--plot", options.plots,
                     "folder for plots of correct against incorrect recognitions", kOutputGroup);
  add_format_flag(command, options.format,
                  "tables of the grid: text (with -v), markdown, latex, or csv with one row per "
                  "cell (default: text)")
      .group(kOutputGroup);
}

}  // namespace

std::vector<uint64_t> parse_counts(const std::string& text, const std::string& flag) {
  std::vector<uint64_t> counts;
  for (const std::optional<double> value : parse_values(text, flag, false)) {
    if (!(*value >= 1 && *value <= 1e9) || *value != std::floor(*value))
      throw Error(ErrorKind::usage, "{} takes integers from 1 to 1000000000, found {:.16g}", flag,
                  *value);
    counts.push_back(static_cast<uint64_t>(*value));
  }
  return counts;
}

void add_fastable(Program& program) {
  const auto tune = std::make_shared<SweepCommand<SequenceKeys>>();
  const Command command = program.add_command(
      "fastable", "Count a grid of c_l and t_r, or margins. All cells are counted in one pass.",
      "  vpr-tune fastable corridor.vprdb --query tuesday --ground-truth pairs.csv\n"
      "  vpr-tune fastable corridor.vprdb --query tuesday --ground-truth pairs.csv --c-l "
      "2,5,10,20,40 --t-r 0.2:0.7:0.05 --save-config best.json -o sweep.json\n"
      "  vpr-tune fastable corridor.vprdb --query tuesday --ground-truth pairs.csv --score zscore "
      "--decide margin --margin 0.2:1:0.1",
      [tune](Session& session) { tune_fastable(session, tune->options, tune->settings); });
  GridFlags& grid = tune->options.grid;
  program.add_config(command, tune->settings);
  add_sweep_flags(command, tune->options);
  command.add_option(
      "--c-l", grid.windows,
      fmt::format("window lengths, as in 2,5,10 or 10:50:10; default: those of {} that fit",
                  kWindowLengths));
  command.add_option(
      "--t-r", grid.thresholds,
      fmt::format("thresholds, as in 0.2:0.6:0.05; negative --t-r=-3:-1:0.25; for raw distances "
                  "also auto (default: {}; in bits {}; for z-scores {})",
                  kDistanceThresholds[0], kDistanceThresholds[1], kDistanceThresholds[2]));
  command.add_option(
      "--margin", grid.margins,
      fmt::format("margins for --decide margin, as in 0.2:1:0.1,auto, where auto is the default "
                  "margin; in score per frame (default: {}; for z-scores {})",
                  kDistanceMargins, kScoreMargins));
  add_settings(command, tune->settings, sequence_setting_rows(), QueryCommand::sweep);
  add_memory_flag(command, tune->options.memory_limit);
}

void add_fabmap(Program& program) {
  const auto tune = std::make_shared<SweepCommand<FabmapQuerySettings>>();
  const Command command = program.add_command(
      "fabmap", "Count a grid of c_w and t_p. All cells are counted in one pass.",
      "  vpr-tune fabmap fabmap.vprdb --query tuesday --ground-truth pairs.csv\n"
      "  vpr-tune fabmap places.vprdb --query tuesday --ground-truth places.csv --c-w 1,3,5,8 "
      "--t-p 0.6,0.9,0.99 --save-config best.json -o sweep.json",
      [tune](Session& session) { tune_fabmap(session, tune->options, tune->settings); });
  GridFlags& grid = tune->options.grid;
  program.add_config(command, tune->settings);
  add_sweep_flags(command, tune->options);
  command.add_option("--c-w", grid.windows,
                     fmt::format("windows, as in 1,3,5,8 (default: {})", kFabmapWindows));
  command.add_option(
      "--t-p", grid.thresholds,
      fmt::format("thresholds, as in 0.5:0.95:0.05,0.99 (default: {})", kPlaceThresholds));
  add_unreadable_flag(command, tune->settings.skip_unreadable).group("Query");
}

}  // namespace vpr
