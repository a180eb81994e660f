#include "query_loop.h"

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "evaluate/loops.h"
#include "run/own_database.h"
#include "sequence/sequence_source.h"
#include "truth/times.h"

namespace vpr {
namespace {

std::string text_of(const SequenceArgument& argument) {
  return argument.path.string() + range_text(argument.range);
}

// Whole seconds, one after the other, may as well count frames.
bool are_numbers_of_frames(const std::vector<int64_t>& times) {
  for (size_t f = 1; f < times.size(); ++f)
    if (times[f] - times[f - 1] != kSecond) return false;
  return times.size() > 1 && times.front() % kSecond == 0;
}

// Where the walk's own frames tell nothing of it, that is no fault of theirs.
std::vector<int64_t> times_of(const SequenceArgument& walk, const QueryInputs& inputs,
                              const Monitor& monitor) {
  if (!inputs.loop.times.empty()) return read_frame_times(inputs.loop.times, monitor);
  try {
    const std::vector<int64_t> times = read_frame_times(text_of(walk), monitor);
    if (are_numbers_of_frames(times))
      warn(monitor, fmt::format("{}: the names of its frames are {} to {}, which are taken for "
                                "seconds; if they count frames, give --times, or the gap in frames",
                                text_of(walk), time_text(times.front()), time_text(times.back())));
    return times;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::data) throw;
    throw Error(ErrorKind::usage,
                fmt::format("{}; a gap in seconds needs times: give them with --times FILE, one a "
                            "line, or the gap in frames, as in --loop-gap 300",
                            error.what()));
  }
}

}  // namespace

LoopWalk describe_loop(const SequenceArgument& walk, const QueryInputs& inputs,
                       const SequenceQuerySettings& settings, const Session& session) {
  LoopWalk described;
  if (settings.loop_gap_s != 0) described.times_ns = times_of(walk, inputs, session.monitor);
  described.query = describe_own(open_sequence(walk), settings, session.monitor);
  const size_t frames = described.query.rows().size();
  if (settings.loop_gap_s != 0 && described.times_ns.size() != frames)
    throw Error(ErrorKind::data,
                fmt::format("{}: has {}, and {} has {}",
                            inputs.loop.times.empty() ? text_of(walk) : inputs.loop.times,
                            counted(described.times_ns.size(), "time"), text_of(walk),
                            counted(frames, "frame")));
  described.database = own_database(described.query, walk.path.filename().string());
  return described;
}

void write_loops(const QueryInputs& inputs, const Result& result, const Session& session) {
  if (!inputs.loop.list.empty())
    session.outputs.file(inputs.loop.list).write(loops_csv(loops_of(result)));
}

}  // namespace vpr
