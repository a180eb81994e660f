// vpr-query live: matches each frame as it arrives.
#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "files/live_lines.h"
#include "query.h"
#include "run/open.h"
#include "sequence/live_source.h"
#include "truth/times.h"

namespace vpr {
namespace {

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
std::string latency_text(std::vector<float> times_ms) {
  const std::string text = counted(times_ms.size(), "frame");
  if (times_ms.empty()) return text;
  const auto middle = times_ms.begin() + static_cast<ptrdiff_t>(times_ms.size() / 2);
  std::nth_element(times_ms.begin(), middle, times_ms.end());
  return text + fmt::format("; from frame to line: median {:.2f} ms, maximum {:.2f} ms", *middle,
                            *std::max_element(middle, times_ms.end()));
}

}  // namespace

void query_live(Session& session, const QueryOptions& options, const ResolvedSettings& settings) {
  refuse(!session.options.output.empty(), "--output",
         "has no effect on live queries; redirect standard output instead");
  refuse(session.command.is_given("--order"), "--order",
         "has no effect on live queries; frames are used as they arrive");
  const QueryResources resources = resources_of(options, session);
  const Unreadable unreadable = settings->skip_unreadable ? Unreadable::skip : Unreadable::fail;
  const SequenceDatabase database =
      open_database(options.database, settings, options.fuse, session.monitor);
  const NamedSource query = open_source(options, unreadable, session);
  warn_of_rates(database, query.fps, *settings, session.monitor);
  Monitor silent = session.monitor;
  silent.progress = nullptr;
  LiveLines lines(database, query.name, settings, resources, session.monitor);
  std::vector<float> times_ms;
  const auto finish = [&] {
    if (const auto line = lines.finish()) session.print_line(*line);
  };
  const auto report = [&] {
    if (!session.options.quiet) fmt::print(stderr, "{}\n", latency_text(times_ms));
  };
  try {
    while (const auto frame = query.source.next(silent)) {
      const Stopwatch watch;
      session.print_line(lines.take(*frame, silent));
      times_ms.push_back(static_cast<float>(1e3 * watch.elapsed_s()));
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
