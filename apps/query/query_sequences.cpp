// Queries of sequences: FastABLE, OpenABLE, LSH and the filter.
#include <algorithm>

#include <fmt/format.h>

#include "base/stopwatch.h"
#include "base/text.h"
#include "files/matrix_file.h"
#include "present/matrix_chart.h"
#include "query.h"
#include "run/advice.h"
#include "run/open.h"

namespace vpr {
namespace {

constexpr size_t kMatrixPixels = 2000;  // per side

QueryInputs inputs_of(const QueryOptions& options, const ResolvedSettings& settings,
                      const Session& session) {
  QueryInputs inputs = options.inputs;
  if (!inputs.scores.path.empty()) {
    inputs.query.sequence.speed = options.selection.speed;
    inputs.query.sequence.seed = session.options.process.seed;
    return inputs;
  }
  const NamedSequence query = find_query(options, false, session);
  inputs.query = {query.name, query.sequence};
  if (!settings->loop)
    inputs.database = std::make_shared<SequenceDatabase>(
        open_database(options.database, settings, options.fuse, session.monitor));
  return inputs;
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
std::string advice_text(const QueryData& data, const Result& result,
                        const QueryResources& resources, const Session& session) {
  if (!needs_advice(result)) return "";
  const auto& settings = std::get<SequenceQuerySettings>(result.settings);
  if (data.scores || settings.loop) return no_recognition_advice(result) + "\n";
  ensure_statistics(*data.database, session.monitor);
  return filter_advice(*data.database, data.query, settings, resources, session.monitor) + "\n";
}

}  // namespace

void query_sequences(Session& session, const QueryOptions& options,
                     const ResolvedSettings& settings) {
  const Monitor& monitor = session.monitor;
  claim_outputs(options, session);
  const QueryResources resources = resources_of(options, session);
  const Stopwatch watch;
  ResultContext context = make_context(options, session);
  const QueryData data =
      open_query(inputs_of(options, settings, session), settings, context, monitor);
  context.seconds["describe"] = watch.elapsed_s();
  SavedMatrix matrix;
  const auto observers = [&](const QueryPlan& plan) -> Sinks {
    return {start_matrix(matrix, options.matrix, plan, settings, session)};
  };
  const QueryRun run = run_query(data, settings, resources, observers, context, monitor);
  context.seconds["total"] = watch.elapsed_s();
  if (options.verify_cells > 0) context.verification = {run.verified_cells, 0};
  finish_matrix(matrix, options.matrix, run.result, context, session);
  const Json json = save_result(session, run.result, context);
  save_loops(options, run.result, session);
  session.print_result(summary(run, session) + advice_text(data, run.result, resources, session),
                       json);
}

}  // namespace vpr
