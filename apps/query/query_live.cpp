// vpr-query --follow: frames as they come.
#include <algorithm>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

#include "base/error.h"
#include "base/stopwatch.h"
#include "base/text.h"
#include "match/match.h"
#include "present/result_file.h"
#include "query_inputs.h"
#include "run/advice.h"
#include "run/live_query.h"
#include "run/train.h"
#include "sequence/live_source.h"
#include "truth/sequence_rate.h"

namespace vpr {
namespace {

// As the flags or the data set say it.
std::optional<double> recorded_fps(const QueryInputs& inputs) {
  if (inputs.selection.recorded_fps || inputs.dataset.empty()) return inputs.selection.recorded_fps;
  const double fps = read_dataset(inputs.dataset).frames_per_second;
  return fps > 0 ? std::optional(fps) : std::nullopt;
}

struct NamedSource {
  std::string name;
  std::optional<double> fps;
  std::unique_ptr<LiveSource> source;
};

// Of what grows, frames are thinned as they come; of what has an end, they are chosen already.
std::unique_ptr<LiveSource> thinned_source(std::unique_ptr<LiveSource> source,
                                           const QueryInputs& inputs) {
  check_rates(inputs.selection);
  if (!inputs.selection.fps) return source;
  return open_thinned_source(std::move(source), *inputs.selection.fps, recorded_fps(inputs));
}

NamedSource open_source(const QueryInputs& inputs, Unreadable unreadable, const Session& session) {
  if (inputs.dataset.empty() && inputs.query == "-")
    return {"standard input", inputs.selection.fps,
            thinned_source(open_live_pipe(STDIN_FILENO), inputs)};
  const NamedSequence query = find_query(inputs, session).sequence;
  auto source = open_live_source(query.sequence, unreadable);
  if (std::filesystem::is_regular_file(query.sequence.path))
    return {query.name, query.sequence.sequence.fps, std::move(source)};
  const auto fps = inputs.selection.fps ? inputs.selection.fps : recorded_fps(inputs);
  return {query.name, fps, thinned_source(std::move(source), inputs)};
}

/// How long frames took, from when they were there until their line was printed, in milliseconds.
class Latencies {
 public:
  void add(double seconds) { all_.push_back(static_cast<float>(1e3 * seconds)); }

  std::string summary() {
    std::string text = counted(all_.size(), "frame");
    if (all_.empty()) return text;
    const auto middle = all_.begin() + static_cast<ptrdiff_t>(all_.size() / 2);
    std::nth_element(all_.begin(), middle, all_.end());
    return text + fmt::format("; from frame to line {:.2f} ms in the median, {:.2f} at worst",
                              *middle, *std::max_element(middle, all_.end()));
  }

 private:
  std::vector<float> all_;
};

/// Frames of a source to lines.
struct Follower {
  const Session& session;
  const SequenceDatabase& database;
  Unreadable unreadable;
  Monitor silent;  ///< no progress for a single frame
  LiveQuery query;
  size_t frames = 0;

  // Nothing for a frame that can't be read, and need not be.
  std::optional<DescriptorSet> describe(const LiveFrame& frame) const {
    try {
      if (frame.is_unreadable)
        throw Error(ErrorKind::input,
                    fmt::format("{}: frame {} can't be decoded", frame.file.string(), frame.name));
      return describe_frames(frame.sequence(), database, false, silent);
    } catch (const Error& error) {
      if (unreadable == Unreadable::fail || error.kind() != ErrorKind::input) throw;
      warn(silent, error.what());
      return std::nullopt;
    }
  }

  void take(const LiveFrame& frame) {
    const auto described = describe(frame);
    const DescriptorShape shape = database.descriptors.rows().shape;
    const std::vector<uint8_t> none(described ? 0 : shape.row_bytes());
    FrameRow row{described ? described->rows()[0] : DescriptorRow(none), described.has_value()};
    if (described && !described->words.empty()) row.words = described->words.front();
    const std::optional<Result> result = query.take(row);
    session.print_line(
        live_line({frames++, frame.name, described.has_value()}, result ? &*result : nullptr, 0));
  }
};

void follow(LiveSource& source, Follower& follower, Latencies& latencies) {
  while (const auto frame = source.next(follower.silent)) {
    const Stopwatch watch;
    follower.take(*frame);
    latencies.add(watch.elapsed_s());
  }
}

}  // namespace

void follow_query(Session& session, const QueryInputs& inputs, const ResolvedSettings& settings) {
  QueryResources resources;
  resources.kernels = session.kernels;
  resources.memory_limit = inputs.memory_limit;
  resources.seed = session.options.seed;
  const Unreadable unreadable = settings->skip_unreadable ? Unreadable::skip : Unreadable::fail;
  const SequenceDatabase database =
      open_database(inputs.database, settings, inputs.fuse, session.monitor);
  const NamedSource query = open_source(inputs, unreadable, session);
  warn_of_rates(database, query.fps, *settings, session.monitor);
  Monitor silent = session.monitor;
  silent.progress = nullptr;
  Follower follower{session, database, unreadable, silent,
                    LiveQuery(database, query.name, settings, resources, session.monitor)};
  Latencies latencies;
  const auto report = [&] {
    if (!session.options.quiet) fmt::print(stderr, "{}\n", latencies.summary());
  };
  try {
    follow(*query.source, follower, latencies);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::interrupted) throw;
    report();
    throw Error(ErrorKind::interrupted, "interrupted");
  }
  report();
}

}  // namespace vpr
