// Queries of sequences: FastABLE, OpenABLE, LSH and the filter.
#include <algorithm>

#include <fmt/format.h>

#include "base/checksum.h"
#include "base/error.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "files/matrix_file.h"
#include "loops/own_database.h"
#include "present/matrix_chart.h"
#include "query.h"
#include "run/advice.h"
#include "run/open.h"
#include "run/query.h"
#include "run/train_sequences.h"
#include "sequence/sequence_source.h"
#include "truth/times.h"

namespace vpr {
namespace {

constexpr size_t kMatrixPixels = 2000;  // per side

/// A query and the data that it is matched with.
struct QueryData {
  NamedSequence source;
  SequenceDatabase database;
  DescriptorSet query;
  std::optional<PrecomputedDistances> scores;  ///< of a matrix; database and query refer to it
  std::vector<int64_t> times_ns;               ///< of the query, for loops with a gap in seconds
};

std::string fingerprint_of(const DescriptorSet& query) {
  return checksum(std::as_bytes(query.rows().bytes));
}

void read_database(QueryData& data, ResultContext& context, const QueryOptions& options,
                   const ResolvedSettings& settings, const Session& session) {
  data.source = find_query(options, false, session);
  data.database = open_database(options.database, settings, options.fuse, session.monitor);
  data.query = describe_query(data.source.sequence, data.database, settings, session.monitor);
  set_query_path(context.run, data.source.sequence);
  context.database_fingerprint = data.database.fingerprint;
  context.query_fingerprint = fingerprint_of(data.query);
  if (const FusedViews* fused = fused_views(data.database))
    context.fused_fingerprint = fused->fabmap.fingerprint;
}

void read_scores(QueryData& data, ResultContext& context, const QueryOptions& options,
                 const Session& session) {
  const ScoreFlags& flags = options.scores;
  data.source.name = options.matrix_name.empty() ? std::filesystem::path(flags.path).stem().string()
                                                 : options.matrix_name;
  require_order(flags);
  const PrecomputedDistances& scores =
      data.scores.emplace(flags.path, flags.format(), session.monitor);
  std::vector<NamedArgument> sequences;
  for (const std::string& text : options.train_sequences)
    sequences.push_back(parse_named_range(text, "", "--train-sequence"));
  MatrixQuery made = matrix_query(scores, sequences);
  data.database = std::move(made.database);
  data.query = selected(std::move(made.query),
                        at_speed(options.selection.speed, scores.queries(), session.options.seed));
  const PrecomputedUnits& units = scores.units();
  context.scores = {flags.order(), units.best, units.unit, units.is_exact};
  context.database_fingerprint = context.query_fingerprint = scores.fingerprint(session.monitor);
}

// Integer seconds in steps of one are possibly numbers of frames.
bool may_be_numbers(const std::vector<int64_t>& times) {
  for (size_t f = 1; f < times.size(); ++f)
    if (times[f] - times[f - 1] != kSecond) return false;
  return times.size() > 1 && times.front() % kSecond == 0;
}

// Times from the names of the frames, which were not made for this purpose: an error is one of
// usage.
std::vector<int64_t> times_of_names(const std::string& query, const Monitor& monitor) {
  try {
    const std::vector<int64_t> times = read_frame_times(query, monitor);
    if (may_be_numbers(times))
      warn(monitor,
           "{}: the names of its frames, {} to {}, are interpreted as seconds; if they count "
           "frames, use --frame-times, or a gap in frames",
           query, time_text(times.front()), time_text(times.back()));
    return times;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::data) throw;
    throw Error(ErrorKind::usage,
                "{}; a gap in seconds needs times. Use --frame-times FILE with one per line, or a "
                "gap in frames, as in --gap 300.",
                error.what());
  }
}

void read_loop(QueryData& data, ResultContext& context, const QueryOptions& options,
               const SequenceQuerySettings& settings, const Session& session) {
  data.source = find_query(options, false, session);
  const SequenceArgument& argument = data.source.sequence;
  const std::string query = argument_text(argument);
  const bool needs_times = settings.loop_gap_s != 0;
  if (needs_times)
    data.times_ns = options.loop_times.empty()
                        ? times_of_names(query, session.monitor)
                        : read_frame_times(options.loop_times, session.monitor);
  data.query = describe_own(open_sequence(argument), settings, session.monitor);
  const size_t frames = data.query.rows().size();
  if (needs_times && data.times_ns.size() != frames)
    throw Error(ErrorKind::data, "{}: has {}, and {} has {}",
                options.loop_times.empty() ? query : options.loop_times,
                counted(data.times_ns.size(), "time"), query, counted(frames, "frame"));
  data.database = own_database(data.query, data.source.name);
  set_query_path(context.run, argument);
  context.database_fingerprint = context.query_fingerprint = fingerprint_of(data.query);
}

/// The score matrix of --save-matrix, from the rows of a query.
struct SavedMatrix {
  std::optional<MatrixFile> file;
  std::optional<RowPixels> pixels;
};

// Whether any cell of the matrix has no score.
bool has_gaps(const QueryPlan& plan) {
  const auto is_unreadable = [](const DescribedFrames& span) { return !span.unreadable.empty(); };
  return !plan.query_sequence.unreadable.empty() || !plan.past.empty() ||
         std::any_of(plan.train.begin(), plan.train.end(), is_unreadable);
}

// The consumer of the rows; none without --save-matrix.
std::vector<RowConsumer> start_matrix(SavedMatrix& saved, const std::string& path,
                                      const QueryPlan& plan, const ResolvedSettings& settings,
                                      const Session& session) {
  if (path.empty()) return {};
  const Result shape = make_result(plan, settings);  // without matches
  if (path.ends_with(".npy"))
    return {std::ref(
        saved.file.emplace(session.outputs.file(path), shape, has_gaps(plan), session.monitor))};
  return {std::ref(saved.pixels.emplace(layout_of(shape), kMatrixPixels))};
}

void finish_matrix(const SavedMatrix& saved, const std::string& path, const Result& result,
                   ResultContext& context, const Session& session) {
  if (saved.file) {
    context.matrix = matrix_layout(layout_of(result));
    context.files["matrix"] = saved.file->entry(session.monitor);
    context.checksums[path] = context.files["matrix"].checksum;
  }
  if (saved.pixels)
    session.outputs.file(path).write(
        chart_png({result_matrix_chart(result, *saved.pixels, nullptr, session.monitor)}));
}

std::string summary(const QueryRun& run, const Session& session) {
  const Result& result = run.result;
  std::string text = summary_text(result, session);
  if (run.verified_cells > 0) text += counted(run.verified_cells, "cell") + ", 0 differences\n";
  if (result.recall)
    text += fmt::format("Compared with an exact search: the best match of {} of {}, and {} of {}\n",
                        result.recall->found_best, counted(result.recall->windows, "window"),
                        result.recognitions.size(),
                        counted(result.recall->recognitions, "recognition"));
  return text;
}

// Advice for few recognitions. The filter needs training sequences and their statistics, which a
// score matrix and a loop query do not have.
std::string advice_text(QueryData& data, const Result& result, const QueryResources& resources,
                        const Session& session) {
  if (const auto sentence = excess_advice(result)) warn(session.monitor, *sentence);
  if (!needs_advice(result)) return "";
  const auto& settings = std::get<SequenceQuerySettings>(result.settings);
  if (data.scores || settings.loop) return no_recognition_advice(result) + "\n";
  ensure_statistics(data.database, session.monitor);
  return filter_advice(data.database, data.query, settings, resources, session.monitor) + "\n";
}

}  // namespace

void query_sequences(Session& session, const QueryOptions& options,
                     const ResolvedSettings& settings) {
  const Monitor& monitor = session.monitor;
  claim_outputs(options, session);
  const QueryResources resources = resources_of(options, session);
  const Stopwatch watch;
  ResultContext context = make_context(options, session);
  context.run.memory_limit = resources.memory_limit;
  QueryData data;
  if (!options.scores.path.empty())
    read_scores(data, context, options, session);
  else if (settings->loop)
    read_loop(data, context, options, *settings, session);
  else
    read_database(data, context, options, settings, session);
  const double describe_s = watch.elapsed_s();
  const std::string& name = data.source.name;
  SavedMatrix matrix;
  QueryPlan plan =
      plan_query(data.database, data.query, name, settings, resources, monitor, data.times_ns);
  const Sinks sinks{start_matrix(matrix, options.matrix, plan, settings, session)};
  QueryRun run = run_query(std::move(plan), settings, resources, sinks, monitor);
  if (settings->loop)
    std::get<SequenceQuerySettings>(run.result.settings).descriptor =
        data.query.descriptors.kind->name;
  context.seconds = std::move(run.seconds);
  context.seconds["describe"] = describe_s;
  context.seconds["total"] = watch.elapsed_s();
  if (options.verify_cells > 0) context.verification = {run.verified_cells, 0};
  finish_matrix(matrix, options.matrix, run.result, context, session);
  const Json json = save_result(session, run.result, context);
  save_loops(options, run.result, session);
  session.print_result(summary(run, session) + advice_text(data, run.result, resources, session),
                       json);
}

}  // namespace vpr
