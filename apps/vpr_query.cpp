// vpr-query: where does a query sequence match a database?
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/checksum.h"
#include "base/stopwatch.h"
#include "command.h"
#include "evaluation/counts.h"
#include "images/dataset.h"
#include "matching/methods.h"
#include "pipeline/query.h"
#include "report/matrix_file.h"
#include "report/matrix_picture.h"
#include "report/result_file.h"
#include "report/table.h"

namespace vpr {
namespace {

constexpr size_t kTableRows = 20;

struct QueryInputs {
  std::string database;
  std::optional<std::string> query;
  std::string dataset;
  std::string ground_truth;
  int tolerance_frames = 0;
  std::string matrix;
  std::string max_memory = "8G";
  uint64_t verify_cells = 0;
};

struct QuerySource {
  NamedSequence sequence;
  std::optional<GroundTruthArgument> ground_truth;
};

QuerySource find_query(const QueryInputs& inputs) {
  QuerySource source;
  if (!inputs.ground_truth.empty())
    source.ground_truth = parse_ground_truth_argument(inputs.ground_truth, inputs.tolerance_frames);
  if (!inputs.dataset.empty()) {
    const Dataset dataset = read_dataset(inputs.dataset);
    const DatasetQuery& query = select_query(dataset, inputs.query);
    source.sequence = query.sequence;
    if (!source.ground_truth) source.ground_truth = query.sequence_ground_truth;
    return source;
  }
  if (!inputs.query) throw Error(ErrorKind::usage, "give the query sequence, as in --query FOLDER");
  const SequenceArgument argument = parse_sequence_argument(*inputs.query);
  source.sequence = {sequence_names({argument}).front(), argument};
  return source;
}

std::string query_fingerprint(const SequenceCodes& query) {
  return checksum(std::as_bytes(std::span(query.codes)));
}

Table places_table(const SequenceResult& result) {
  Table table;
  table.title = fmt::format("{}: {} hits in {} places", result.query_name, result.hits.size(),
                            result.places.size());
  table.columns = {"sequence", "query frame", "train frame", "hits", "bits/frame"};
  for (const Recognition& place : result.places) {
    if (table.rows.size() == kTableRows) break;
    table.rows.push_back(
        {result.sequences[place.sequence].name, std::to_string(result.anchor(place.query_window)),
         std::to_string(result.anchor(place.train_window)), std::to_string(place.hits),
         fmt::format("{:.1f}", static_cast<double>(place.best_distance) /
                                   static_cast<double>(result.settings.window_length))});
  }
  return table;
}

std::string summary(const QueryRun& run) {
  const SequenceResult& result = run.result;
  std::string text = render_table(places_table(result), TableFormat::text);
  if (result.places.size() > kTableRows)
    text += fmt::format("... and {} more\n", result.places.size() - kTableRows);
  if (run.verified_cells > 0) text += fmt::format("{} cells, 0 differences\n", run.verified_cells);
  return text;
}

void check_matrix_output(const QueryInputs& inputs, Existing existing) {
  if (inputs.matrix.empty()) return;
  if (!inputs.matrix.ends_with(".npy") && !inputs.matrix.ends_with(".png"))
    throw Error(ErrorKind::usage,
                fmt::format("--save-matrix writes .npy or .png, found {}", inputs.matrix));
  check_output_file(inputs.matrix, existing);
}

void run(Session& session, const QueryInputs& inputs, const SequenceQuerySettings& settings) {
  const CommonOptions& options = session.options;
  if (options.output.empty() && !options.json)
    throw Error(ErrorKind::usage, "give the result to write, as in -o RESULT.json, or --json");
  if (!options.output.empty()) check_result_output(options.output, options.existing());
  check_matrix_output(inputs, options.existing());
  QueryResources resources;
  resources.kernels = session.kernels;
  resources.memory_limit = parse_bytes(inputs.max_memory, "--max-memory");
  resources.verify_cells = inputs.verify_cells;
  resources.seed = options.seed;

  const Stopwatch watch;
  const QuerySource source = find_query(inputs);
  const SequenceDatabase database = read_sequence_database(inputs.database);
  const SequenceCodes query = describe_sequence(
      open_sequence(source.sequence.sequence), database.descriptor,
      settings.skip_unreadable ? Unreadable::skip : Unreadable::fail, session.monitor);
  const double describe_s = watch.elapsed_s();
  SequenceResult planned =
      plan_query(database, query, source.sequence.name, settings, resources, session.monitor);
  std::optional<GroundTruth> truth;
  if (source.ground_truth && inputs.matrix.ends_with(".png"))
    truth = read_ground_truth(*source.ground_truth, scope_of(planned));

  const MatrixLayout layout = matrix_layout(planned);
  std::optional<MatrixFile> matrix;
  std::optional<MatrixPicture> picture;
  std::vector<RowConsumer> observers;
  if (inputs.matrix.ends_with(".npy"))
    observers.emplace_back(std::ref(matrix.emplace(inputs.matrix, options.existing(), layout)));
  if (inputs.matrix.ends_with(".png")) observers.emplace_back(std::ref(picture.emplace(layout)));

  QueryRun found =
      run_query(std::move(planned), database, query, resources, observers, session.monitor);
  found.seconds["describe"] = describe_s;
  found.seconds["total"] = watch.elapsed_s();

  ResultContext context;
  context.run = session.run;
  context.run.simd_target = session.kernels.target;
  context.run.memory_limit = resources.memory_limit;
  context.run.paths = {{"database", inputs.database},
                       {"query", source.sequence.sequence.path.string()}};
  context.database_fingerprint = database.fingerprint;
  context.query_fingerprint = query_fingerprint(query);
  context.seconds = found.seconds;
  if (inputs.verify_cells > 0) context.verified_cells = found.verified_cells;
  if (matrix) context.matrix = matrix_layout_json(layout, found.result);
  if (matrix) matrix->commit();
  if (picture)
    picture->write(inputs.matrix, options.existing(), found.result, truth ? &*truth : nullptr);
  const Json json = options.output.empty()
                        ? result_json(found.result, context)
                        : write_result(options.output, found.result, context, options.existing());
  session.print_result(summary(found), json);
}

std::string method_help() {
  std::vector<std::string> lines;
  for (const SequenceMethod& method : sequence_methods())
    lines.push_back(fmt::format("{} ({})", method.name, method.summary));
  return fmt::format("{}; default fastable", fmt::join(lines, ", "));
}

}  // namespace
}  // namespace vpr

int main(int argc, char** argv) {
  using namespace vpr;
  Program program("vpr-query", "Recognise the places of a query sequence in a database.",
                  "  vpr-query corridor.vprdb --query corridor/query --c-l 20 --t-r 0.65 "
                  "-o result.json");
  QueryInputs inputs;
  SequenceQuerySettings settings;
  CLI::App& app = program.app();
  app.add_option("DB", inputs.database, "database made by vpr-train")->required();
  app.add_option("--query", inputs.query,
                 "query sequence: folder, list or video, with an optional range "
                 "PATH@FIRST:LAST[:STEP]; with --dataset, the name of one of its queries");
  app.add_option("--dataset", inputs.dataset, "data set description that holds the query");
  program.add_config(app, settings);
  add_setting(app, "--method", settings.method, method_help());
  add_setting(app, "--c-l", settings.window_length, "window length c_l in frames (default 40)");
  add_setting(app, "--t-r", settings.distance_threshold,
              "threshold t_r: a number, or auto (default): from how close training sequences come");
  add_setting(app, "--t-r-scale", settings.threshold_scale,
              "of a number: relative (D / max D, default) or bits (D / c_l)");
  add_setting(app, "--safety-factor", settings.safety_factor,
              "multiplies the automatic t_r (default: the database's)");
  app.add_option("--only-sequence", settings.only_sequences,
                 "search only this training sequence; repeatable")
      ->expected(1)
      ->take_all();
  app.add_flag("--skip-unreadable", settings.skip_unreadable,
               "frames that can't be decoded keep their index and never match");
  app.add_option("--save-matrix", inputs.matrix,
                 "write the distances: .npy (int32, never whole in memory) or .png (dark: close)");
  app.add_option("--ground-truth", inputs.ground_truth,
                 "pairs file, or the word aligned: drawn into the picture");
  app.add_option("--tolerance", inputs.tolerance_frames, "of the ground truth, in frames");
  app.add_option("--verify", inputs.verify_cells,
                 "recompute so many random cells by the definition; exit code 5 if one differs");
  app.add_option("--max-memory", inputs.max_memory,
                 "for rings and hits, as in 512M; more is computed twice instead (default 8G)");
  program.set_run([&](Session& session) { run(session, inputs, settings); });
  return program.main(argc, argv);
}
