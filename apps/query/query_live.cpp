// vpr-query live: matches each frame as it arrives.
#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "files/result_file.h"
#include "query.h"
#include "run/live_query.h"
#include "run/open.h"
#include "run/train_sequences.h"
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
  std::unique_ptr<LiveSource> source;
};

// Selects frames of an endless source as they arrive; those of other sources are selected already.
std::unique_ptr<LiveSource> resampled_source(std::unique_ptr<LiveSource> source,
                                             const QueryOptions& options) {
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

/// Prints one line per frame.
struct Follower {
  const Session& session;
  const SequenceDatabase& database;
  Unreadable unreadable;
  Monitor silent;  ///< without progress
  LiveQuery query;
  size_t frames = 0;

  // Nullopt for an unreadable frame with --skip-unreadable.
  std::optional<DescriptorSet> describe(const LiveFrame& frame) const {
    try {
      if (frame.is_unreadable)
        throw Error(ErrorKind::input, "{}: frame {} cannot be decoded", frame.file.string(),
                    frame.name);
      return describe_frames(frame.sequence(), database, false, silent);
    } catch (const Error& error) {
      if (unreadable == Unreadable::fail || error.kind() != ErrorKind::input) throw;
      warn(silent, error.what());
      return std::nullopt;
    }
  }

  LineFrame last = {};  ///< the latest frame

  void take(const LiveFrame& frame) {
    const auto described = describe(frame);
    const DescriptorShape shape = database.descriptors.rows().shape;
    const std::vector<uint8_t> none(described ? 0 : shape.row_bytes());
    ArrivedFrame row{described ? described->rows()[0] : DescriptorRow(none), described.has_value()};
    if (described && !described->words.empty()) row.words = described->words.front();
    const std::optional<Result> result = query.take(row);
    last = {frames++, frame.name, described.has_value()};
    session.print_line(live_line(last, result ? &*result : nullptr, 0));
  }

  void finish() {
    if (const std::optional<Result> result = query.finish())
      session.print_line(live_line(last, &*result, 0));
  }
};

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
  Follower follower{session, database, unreadable, silent,
                    LiveQuery(database, query.name, settings, resources, session.monitor)};
  std::vector<float> times_ms;
  const auto report = [&] {
    if (!session.options.quiet) fmt::print(stderr, "{}\n", latency_text(times_ms));
  };
  try {
    while (const auto frame = query.source->next(silent)) {
      const Stopwatch watch;
      follower.take(*frame);
      times_ms.push_back(static_cast<float>(1e3 * watch.elapsed_s()));
    }
    follower.finish();
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::interrupted) throw;
    follower.finish();
    report();
    throw Error(ErrorKind::interrupted, "interrupted");
  }
  report();
}

}  // namespace vpr
