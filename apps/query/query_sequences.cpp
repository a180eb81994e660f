// vpr-query against a database of sequences: FastABLE, OpenABLE.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/checksum.h"
#include "base/error.h"
#include "base/json.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "evaluate/counts.h"
#include "present/result_file.h"
#include "present/table.h"
#include "query_inputs.h"
#include "query_loop.h"
#include "run/advice.h"
#include "run/fuse.h"
#include "run/own_database.h"
#include "run/query.h"
#include "run/train.h"
#include "saved_matrix.h"
#include "sequence/sequence_source.h"

namespace vpr {
namespace {

constexpr size_t kTableRows = 20;

std::string query_fingerprint(const DescriptorSet& query) {
  return checksum(std::as_bytes(query.rows().bytes));
}

// The anchors of windows `first` to `last`.
std::string anchors_text(size_t first, size_t last, size_t length) {
  const std::string text = std::to_string(anchor_of(first, length));
  return first == last ? text : fmt::format("{} to {}", text, anchor_of(last, length));
}

std::string rate_text(const Cluster& track) {
  const auto rate = mean_rate(track);
  return rate ? fmt::format("{:.2f}", *rate) : "-";
}

Table places_table(const Result& result) {
  Table table;
  table.title = fmt::format("{}: {} in {}, {} of {} recognized", query_title(result),
                            counted(result.recognitions.size(), "recognition"),
                            counted(result.clusters->all.size(), "place"),
                            recognized_windows(result), counted(result.query_windows, "window"));
  const ScoreKind& kind = result.score();
  const size_t length = result.window_length();
  table.columns = {"sequence", "query frames", "train frames", "recognitions",
                   result.path ? "rate" : std::string(kind.frame_unit)};
  for (const Cluster& cluster : result.clusters->all) {
    if (table.rows.size() == kTableRows) break;
    const std::string value =
        fmt::format("{:.{}f}", kind.frame_value(cluster.best_score, length), kind.frame_digits);
    table.rows.push_back({result.targets[cluster.target].sequence.name,
                          anchors_text(cluster.query_first, cluster.query_last, length),
                          anchors_text(cluster.train_first, cluster.train_last, length),
                          std::to_string(cluster.recognitions),
                          result.path ? rate_text(cluster) : value});
  }
  return table;
}

std::string summary(const QueryRun& run) {
  const Result& result = run.result;
  std::string text = render_table(places_table(result), TableFormat::text);
  const size_t clusters = result.clusters->all.size();
  if (clusters > kTableRows) text += fmt::format("... and {} more\n", clusters - kTableRows);
  if (run.verified_cells > 0) text += counted(run.verified_cells, "cell") + ", 0 differences\n";
  if (result.recall)
    text += fmt::format(
        "Against an exact search: the best match of {} of {} was found, and {} of {}\n",
        result.recall->found_best, counted(result.recall->windows, "window"),
        result.recognitions.size(), counted(result.recall->recognitions, "recognition"));
  return text;
}

/// What a query is compared with, and what files say of both.
struct Sides {
  std::optional<GivenDistances> given;  ///< of --scores
  SequenceDatabase database;
  DescriptorSet query;
  QuerySource source;
  ResultContext context;
  std::vector<int64_t> times_ns;  ///< of --loop
};

// A matrix and a walk against its own past have no training sequences that the filter needs.
std::string advice_text(Sides& sides, const Result& result, const QueryResources& resources,
                        const Session& session) {
  if (const auto sentence = too_many_recognitions(result)) warn(session.monitor, *sentence);
  if (!result.recognitions.empty()) return "";
  const auto& settings = std::get<SequenceQuerySettings>(result.settings);
  if (sides.given || settings.loop || has_paths(settings.method))
    return nothing_recognized(result) + "\n";
  ensure_statistics(sides.database, session.monitor);
  return filter_finding(sides.database, sides.query, settings, resources, session.monitor) + "\n";
}

void describe_own(Sides& sides, const Session& session, const QueryInputs& inputs,
                  const SequenceQuerySettings& settings) {
  sides.source = find_query(inputs, session);
  LoopWalk walk = describe_loop(sides.source.sequence.sequence, inputs, settings, session);
  sides.database = std::move(walk.database);
  sides.database.sequences.front().sequence.name = sides.source.sequence.name;
  sides.query = std::move(walk.query);
  sides.times_ns = std::move(walk.times_ns);
  sides.context.database_fingerprint = sides.context.query_fingerprint =
      query_fingerprint(sides.query);
}

void describe(Sides& sides, const Session& session, const QueryInputs& inputs,
              const ResolvedSettings& settings) {
  sides.source = find_query(inputs, session);
  sides.database = open_database(inputs.database, settings, inputs.fuse, session.monitor);
  sides.query =
      describe_query(sides.source.sequence.sequence, sides.database, settings, session.monitor);
  sides.context.database_fingerprint = sides.database.fingerprint;
  sides.context.query_fingerprint = query_fingerprint(sides.query);
  if (const FusedViews* fused = fused_views(sides.database))
    sides.context.fused_fingerprint = fused->fabmap.fingerprint;
}

void take_scores(Sides& sides, const Session& session, const QueryInputs& inputs) {
  sides.source = find_scored_query(inputs);
  const GivenDistances& given = sides.given.emplace(inputs.scores.matrix.path,
                                                    inputs.scores.matrix.format(), session.monitor);
  MatrixQuery made = matrix_query(given, scored_sequences(inputs.scores));
  sides.database = std::move(made.database);
  sides.query = selected(std::move(made.query),
                         warped(inputs.selection.warp, given.queries(), session.options.seed));
  const GivenUnits& units = given.units();
  sides.context.scores = {{"kind", enum_name(inputs.scores.matrix.order())},
                          {"best", units.best},
                          {"unit", units.unit},
                          {"is_exact", units.is_exact}};
  const std::string fingerprint = given.fingerprint(session.monitor);
  sides.context.database_fingerprint = sides.context.query_fingerprint = fingerprint;
}

QueryResources resources_of(const Session& session, const QueryInputs& inputs) {
  QueryResources resources;
  resources.kernels = session.kernels;
  resources.memory_limit = inputs.memory_limit;
  resources.verify_cells = inputs.verify_cells;
  resources.seed = session.options.seed;
  return resources;
}

// Before anything is read.
void claim_outputs(const Session& session, const QueryInputs& inputs) {
  if (!session.options.output.empty()) claim_result(session.options.output, session.outputs);
  claim_matrix(inputs, session.outputs);
  if (!inputs.loop.list.empty()) session.outputs.claim_file(inputs.loop.list);
}

}  // namespace

void run_sequence_query(Session& session, const QueryInputs& inputs,
                        const ResolvedSettings& settings) {
  if (inputs.follow) return follow_query(session, inputs, settings);
  claim_outputs(session, inputs);
  const QueryResources resources = resources_of(session, inputs);

  const Stopwatch watch;
  Sides sides;
  const bool has_scores = !inputs.scores.matrix.path.empty();
  has_scores       ? take_scores(sides, session, inputs)
  : settings->loop ? describe_own(sides, session, inputs, *settings)
                   : describe(sides, session, inputs, settings);
  const SequenceDatabase& database = sides.database;
  const DescriptorSet& query = sides.query;
  const QuerySource& source = sides.source;
  const ResultContext& known = sides.context;
  const double describe_s = watch.elapsed_s();
  const std::string& name = source.sequence.name;
  SavedMatrix matrix;
  std::optional<GroundTruth> truth;
  const auto search = [&] {
    QueryPlan planned =
        settings->loop
            ? plan_loop(database, query, name, settings, sides.times_ns, resources, session.monitor)
            : plan_query(database, query, name, settings, resources, session.monitor);
    const Result shape = make_result(planned);  // without matches
    if (source.ground_truth && inputs.matrix.ends_with(".png")) {
      GroundTruthScope scope = scope_of(shape);
      scope.query_names = [&] { return query.sequence.frame_names; };
      for (size_t s = 0; s < scope.sequences.size(); ++s)
        scope.sequences[s].names = [&, s] { return database.sequences[s].sequence.frame_names; };
      truth = read_ground_truth(*source.ground_truth, scope, session.monitor);
    }
    const Sinks observers{start_matrix(matrix, inputs.matrix, planned, shape, session)};
    return run_query(std::move(planned), resources, observers, session.monitor);
  };
  QueryRun found = search();
  found.seconds["describe"] = describe_s;
  found.seconds["total"] = watch.elapsed_s();

  ResultContext context = context_of(
      session, inputs,
      source.sequence.sequence.path.string() + range_text(source.sequence.sequence.range),
      found.seconds);
  context.run.memory_limit = resources.memory_limit;
  context.scores = known.scores;
  context.database_fingerprint = known.database_fingerprint;
  context.query_fingerprint = known.query_fingerprint;
  context.fused_fingerprint = known.fused_fingerprint;
  if (inputs.verify_cells > 0) context.verified_cells = found.verified_cells;
  finish_matrix(matrix, inputs.matrix, found.result, truth, context, session);
  const Json json = keep_result(session, found.result, context);
  write_loops(inputs, found.result, session);
  session.print_result(summary(found) + advice_text(sides, found.result, resources, session), json);
}

}  // namespace vpr
