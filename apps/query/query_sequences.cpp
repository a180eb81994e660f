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
#include "present/evaluation_text.h"
#include "present/matrix_chart.h"
#include "query.h"
#include "query/advice.h"
#include "query/live_lines.h"
#include "query/matrix_file.h"
#include "query/open.h"
#include "query/prepare.h"
#include "recordings/live_source.h"
#include "recordings/sequence_source.h"
#include "truth/frame_times.h"

namespace vpr {
namespace {

constexpr size_t kMatrixPixels = 2000;  // per side

QueryInputs inputs_of(const QueryOptions& options, const SequenceQuerySettings& settings,
                      const Session& session) {
  const NamedSequence query = find_query(options, session);
  QueryInputs inputs{{query.name, query.sequence}, nullptr, options.frame_times};
  if (!settings.past)
    inputs.database = std::make_shared<SequenceDatabase>(
        open_database(options.database, settings, session.monitor));
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
  return !plan.result.query.unreadable.empty() || !plan.result.past.empty() ||
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
  if (result.recall)
    text += fmt::format("Compared with an exact search: the best match of {} of {}, and {} of {}\n",
                        result.recall->found_best, counted(result.recall->windows, "window"),
                        result.recognitions.size(),
                        counted(result.recall->recognitions, "recognition"));
  return text;
}

// Advice for few recognitions. The filter needs training sequences and their statistics, which a
// loop query does not have.
std::string advice_text(const QueryData& data, const SequenceArgument& images, const Result& result,
                        const QueryResources& resources, const Session& session) {
  if (!needs_advice(result)) return "";
  const auto& settings = std::get<SequenceQuerySettings>(result.settings);
  if (settings.past) return wrapped_text(no_recognition_advice(result));
  ensure_statistics(*data.database, session.monitor);
  const std::string advice = filter_advice(*data.database, data.query, settings, resources,
                                           session.monitor, &result, &images);
  return advice.empty() ? "" : wrapped_text(advice);
}

struct NamedSource {
  std::string name;
  std::optional<double> fps;
  LiveSource source;
};

// Selects frames of an endless source as they arrive.
NamedSource endless_source(const std::string& name, LiveSource source,
                           const SelectionSettings& selection) {
  check_rates(selection);
  const auto& fps = selection.fps;
  if (!fps) return {name, selection.recorded_fps, std::move(source)};
  return {name, fps, open_resampled_source(std::move(source), *fps, selection.recorded_fps)};
}

NamedSource open_source(const QueryOptions& options, Unreadable unreadable,
                        const Session& session) {
  if (options.dataset.empty() && options.query == "-")
    return endless_source("standard input", open_live_pipe(STDIN_FILENO), options.selection);
  const NamedSequence query = find_query(options, session);
  LiveSource source = open_live_source(query.sequence, unreadable);
  if (is_camera(query.sequence.path))
    return endless_source(query.name, std::move(source), options.selection);
  return {query.name, query.sequence.sequence.fps, std::move(source)};
}

// A note for a folder, which is read to its end.
void print_folder_note(const QueryOptions& options, const Session& session) {
  const std::string path = options.dataset.empty() ? options.query.value_or("") : "";
  std::error_code ignored;
  if (!session.options.quiet && std::filesystem::is_directory(path, ignored))
    write_to_stderr(fmt::format(
        "{}: matches the images that exist now. To match new images as they arrive, use\n"
        "  inotifywait -m -q -e close_write -e moved_to --format '%w%f' {} | vpr-query live {} "
        "--query -\n",
        path, shell_word(path), shell_word(options.database)));
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
                     const SequenceQuerySettings& settings) {
  const Monitor& monitor = session.monitor;
  claim_outputs(options, session);
  const QueryResources resources = resources_of(options, session);
  const Stopwatch watch;
  ResultContext context = make_context(options, session);
  const QueryInputs inputs = inputs_of(options, settings, session);
  const QueryData data = open_query(inputs, settings, context, monitor);
  context.seconds["describe"] = watch.elapsed_s();
  SavedMatrix matrix;
  const auto observers = [&](const QueryPlan& plan) -> Sinks {
    return {start_matrix(matrix, options.matrix, plan, session)};
  };
  const QueryRun run = run_query(data, settings, resources, observers, context, monitor);
  context.seconds["total"] = watch.elapsed_s();
  finish_matrix(matrix, options.matrix, run.result, context, session);
  const Json json = save_result(session, run.result, context);
  save_loops(options, run.result, session);
  session.print_result(summary(run, options, session), json, [&] {
    return advice_text(data, inputs.query.sequence, run.result, resources, session);
  });
}

void query_live(Session& session, const QueryOptions& options,
                const SequenceQuerySettings& settings) {
  refuse(!session.options.output.empty(), "--output",
         "has no effect on live queries; redirect standard output instead");
  const QueryResources resources = resources_of(options, session);
  const Unreadable unreadable = settings.skip_unreadable ? Unreadable::skip : Unreadable::fail;
  const SequenceDatabase database = open_live_database(options.database, settings, session.monitor);
  const NamedSource query = open_source(options, unreadable, session);
  warn_of_rates(database, query.fps, settings, session.monitor);
  Monitor silent = session.monitor;
  silent.progress = nullptr;
  LiveLines lines(database, query.name, settings, resources, session.monitor);
  print_folder_note(options, session);
  std::vector<double> times_ms;
  const auto finish = [&] {
    if (const auto answer = lines.finish()) session.print_line(lines.line(answer));
  };
  const auto report = [&] {
    if (!session.options.quiet) write_to_stderr(latency_text(times_ms) + "\n");
  };
  try {
    while (const auto frame = query.source.next(silent)) {
      const Stopwatch watch;
      const size_t frames = lines.frames();
      const std::optional<LiveAnswer> answer = lines.take(*frame, silent);
      if (lines.frames() == frames) continue;  // it is gone
      session.print_line(lines.line(answer));
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
