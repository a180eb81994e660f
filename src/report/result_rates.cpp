// Rates, and frames of recordings, of result files.
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/npy.h"
#include "images/selection.h"
#include "report/result_arrays.h"
#include "report/result_file.h"

namespace vpr {
namespace {

// To which rate frames were thinned, and of how many.
void read_thinned(const Fields& sequence, Replay& replay, uint64_t frames) {
  const Fields thinned = sequence.object("thinned");
  replay.fps = read_fps(thinned);
  replay.recorded_frames = thinned.count("frames", kMostThinned * frames);
}

}  // namespace

void read_kept(const ResultSource& source, Result& result) {
  const Json& targets = source.fields.list("targets");
  const auto is_thinned = [](const Json& json) { return json.contains("thinned"); };
  if (std::none_of(targets.begin(), targets.end(), is_thinned)) return;
  const NpyArray array =
      read_companion(companion_path(source.path, "train_source_frames.npy"),
                     source.fields.object("files").object("train_source_frames"));
  const auto rows = array.values<int32_t>(1);
  size_t next = 0;
  for (size_t t = 0; t < result.targets.size(); ++t) {
    if (!is_thinned(targets[t])) continue;
    Target& target = result.targets[t];
    Replay stated;
    read_thinned(Fields(targets[t], source.where), stated, target.frames);
    if (target.frames > rows.size() - next)
      source.fields.fail("train_source_frames.npy does not fit the targets");
    target.kept =
        kept_frames(rows.subspan(next, target.frames), stated.recorded_frames, stated.fps);
    if (!target.kept) source.fields.fail("train_source_frames.npy holds frames out of order");
    next += target.frames;
  }
  if (next != rows.size()) source.fields.fail("train_source_frames.npy does not fit the targets");
}

void read_replay(const ResultSource& source, Result& result) {
  const Fields query = source.fields.object("query");
  if (!query.has("warp") && !query.has("thinned")) return;
  Replay& replay = result.replay.emplace();
  if (query.has("thinned")) read_thinned(query, replay, result.query_frames);
  if (query.has("warp")) {
    const Fields warp = query.object("warp");
    replay.warp = warp.text("name");
    replay.seed = warp.count("seed", std::numeric_limits<uint64_t>::max());
    replay.recorded_frames =
        warp.count("frames", (replay.fps > 0 ? kMostThinned : 1) *
                                 static_cast<uint64_t>(kFastestPace) * result.query_frames);
  }
  const NpyArray array = read_companion(companion_path(source.path, "source_frames.npy"),
                                        source.fields.object("files").object("source_frames"));
  for (const int32_t frame : array.values<int32_t>(1)) {
    if (frame < 0 || static_cast<size_t>(frame) >= replay.recorded_frames)
      source.fields.fail("source_frames.npy holds a frame that the query does not have");
    replay.sources.push_back(static_cast<uint32_t>(frame));
  }
  if (replay.frames() != result.query_frames)
    source.fields.fail("source_frames.npy does not fit the query");
}

}  // namespace vpr
