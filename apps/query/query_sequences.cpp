// Queries of sequences: FastABLE, OpenABLE, LSH and the filter; whole, or frame by frame.
#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "base/error.h"
#include "base/statistics.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "common/progress.h"
#include "files/live_lines.h"
#include "files/matrix_file.h"
#include "present/evaluation_text.h"
#include "present/matrix_chart.h"
#include "query.h"
#include "run/advice.h"
#include "run/open.h"
#include "sequence/live_source.h"
#include "truth/times.h"

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
  return !plan.result.query.unreadable.empty() || !plan.past.empty() ||
         std::any_of(plan.train.begin(), plan.train.end(), is_unreadable);
}

// The consumer of the rows; none without --save-matrix.
std::vector<RowConsumer> start_matrix(SavedMatrix& saved, const std::string& path,
                                      const QueryPlan& plan, const Session& session) {
  if (path.empty()) return {};
  if (path.ends_with(".npy"))
    return {std::ref(saved.file.emplace(session.outputs.file(path), plan.result, has_gaps(plan),
                                        session.monitor))};
  return {std::ref(saved.pixels.emplace(layout_of(plan.result), kMatrixPixels))};
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
        chart_png({result_matrix_chart(result, *saved.pixels, session.monitor)}));
}

std::string summary(const QueryRun& run, const QueryOptions& options, const Session& session) {
  const Result& result = run.result;
  std::string text = summary_text(result, options, session);
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
  if (data.scores || settings.loop) return wrapped_text(no_recognition_advice(result));
  ensure_statistics(*data.database, session.monitor);
  return wrapped_text(
      filter_advice(*data.database, data.query, settings, resources, session.monitor));
}

// From the flags or the data set.
std::optional<double> recorded_fps(const QueryOptions& options) {
  if (options.selection.recorded_fps || options.dataset.empty())
    return options.selection.recorded_fps;
  const double fps = read_dataset(options.dataset).frames_per_second;
  return fps > 0 ? std::optional(fps) : std::nullopt;
}

struct NamedSource {
  std::string name;
  std::optional<double> fps;
  LiveSource source;
};

// Selects frames of an endless source as they arrive; those of other sources are selected already.
LiveSource resampled_source(LiveSource source, const QueryOptions& options) {
  check_rates(options.selection);
  if (!options.selection.fps) return source;
  return open_resampled_source(std::move(source), *options.selection.fps, recorded_fps(options));
}

NamedSource open_source(const QueryOptions& options, Unreadable unreadable,
                        const Session& session) {
  if (options.dataset.empty() && options.query == "-")
    return {"standard input", options.selection.fps,
            resampled_source(open_live_pipe(STDIN_FILENO), options)};
  const NamedSequence query = find_query(options, true, session);
  auto source = open_live_source(query.sequence, unreadable);
  if (std::filesystem::is_regular_file(query.sequence.path))
    return {query.name, query.sequence.sequence.fps, std::move(source)};
  const auto fps = options.selection.fps ? options.selection.fps : recorded_fps(options);
  return {query.name, fps, resampled_source(std::move(source), options)};
}

// `times_ms`: from the arrival of a frame to its printed line.
std::string latency_text(const std::vector<double>& times_ms) {
  const std::string text = counted(times_ms.size(), "frame");
  if (times_ms.empty()) return text;
  return text + fmt::format("; from frame to line: median {:.2f} ms, maximum {:.2f} ms",
                            median(times_ms), std::ranges::max(times_ms));
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
    return {start_matrix(matrix, options.matrix, plan, session)};
  };
  const QueryRun run = run_query(data, settings, resources, observers, context, monitor);
  context.seconds["total"] = watch.elapsed_s();
  if (options.verify_cells > 0) context.verification = {run.verified_cells, 0};
  finish_matrix(matrix, options.matrix, run.result, context, session);
  const Json json = save_result(session, run.result, context);
  save_loops(options, run.result, session);
  session.print_result(summary(run, options, session), json,
                       [&] { return advice_text(data, run.result, resources, session); });
}

void query_live(Session& session, const QueryOptions& options, const ResolvedSettings& settings) {
  refuse(!session.options.output.empty(), "--output",
         "has no effect on live queries; redirect standard output instead");
  const QueryResources resources = resources_of(options, session);
  const Unreadable unreadable = settings->skip_unreadable ? Unreadable::skip : Unreadable::fail;
  const SequenceDatabase database =
      open_database(options.database, settings, options.fuse, session.monitor);
  const NamedSource query = open_source(options, unreadable, session);
  warn_of_rates(database, query.fps, *settings, session.monitor);
  Monitor silent = session.monitor;
  silent.progress = nullptr;
  LiveLines lines(database, query.name, settings, resources, session.monitor);
  std::vector<double> times_ms;
  const auto finish = [&] {
    if (const auto result = lines.finish()) session.print_line(lines.line(result));
  };
  const auto report = [&] {
    if (!session.options.quiet) write_to_stderr(latency_text(times_ms) + "\n");
  };
  try {
    while (const auto frame = query.source.next(silent)) {
      const Stopwatch watch;
      session.print_line(lines.line(lines.take(*frame, silent)));
      times_ms.push_back(1e3 * watch.elapsed_s());
    }
    finish();
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::interrupted) throw;
    finish();
    report();
    throw Error(ErrorKind::interrupted, "interrupted");
  }
  report();
}

}  // namespace vpr
