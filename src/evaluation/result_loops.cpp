#include "evaluation/result_loops.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"

namespace vpr {
namespace {

constexpr size_t kFirstLine = 2;  // behind the header

bool is_hit(const Result& result, const Match& match) {
  const auto found = std::lower_bound(
      result.hits.begin(), result.hits.end(), match, [](const Match& a, const Match& b) {
        return a.query != b.query ? a.query < b.query : a.train < b.train;
      });
  return found != result.hits.end() && found->query == match.query && found->train == match.train;
}

bool is_decided(const Result& result) {
  const auto* settings = std::get_if<SequenceQuerySettings>(&result.settings);
  return settings != nullptr &&
         (settings->decision == Decision::margin || settings->distance_threshold);
}

// FAB-MAP's places are the query's own frames, behind those of a database, if it has any.
size_t first_own_place(const Result& result) {
  return result.places ? result.targets.front().frames - result.query_frames : 0;
}

}  // namespace

bool has_loops(const Result& result) {
  return std::visit([](const auto& settings) { return settings.loop; }, result.settings);
}

std::vector<ListedLoop> loops_of(const Result& result) {
  std::vector<ListedLoop> loops;
  const size_t length = result.window_length();
  const ScoreKind& kind = result.score();
  const size_t first = first_own_place(result);
  for (const auto& best : result.best) {
    if (!best || best->train < first) continue;
    if (is_decided(result) && !is_hit(result, *best)) continue;
    const double score =
        kind.frame_value == nullptr ? best->score : kind.frame_value(best->score, length);
    loops.push_back({anchor_of(best->query, length), anchor_of(best->train - first, length), score,
                     loops.size() + kFirstLine});
  }
  return loops;
}

LoopList loop_list_of(const Result& result, const std::string& name, const Trajectory& trajectory) {
  if (!has_loops(result))
    throw Error(ErrorKind::data,
                fmt::format("{}: is not of a walk against its own past, and has no loops; make one "
                            "with vpr-query --loop --query FOLDER",
                            name));
  if (result.query_frames != trajectory.poses.size())
    throw Error(ErrorKind::data,
                fmt::format("{}: is of {}, and {} has {}; give the poses of these frames", name,
                            counted(result.query_frames, "frame"), trajectory.name,
                            counted(trajectory.poses.size(), "pose")));
  LoopList list{name, loops_of(result), false, true};
  for (const ListedLoop& loop : list.loops)
    for (const size_t frame : {loop.query, loop.match})
      if (!trajectory.poses[frame])
        throw Error(ErrorKind::data, fmt::format("{}: has a loop of frame {}, of which {} has no "
                                                 "pose",
                                                 name, frame, trajectory.name));
  return list;
}

std::string loops_csv(const std::vector<ListedLoop>& loops) {
  std::string text = "query,match,score\n";
  for (const ListedLoop& loop : loops)
    text += fmt::format("{},{},{}\n", loop.query, loop.match, *loop.score);
  return text;
}

}  // namespace vpr
