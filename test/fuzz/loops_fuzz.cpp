// A trajectory, its times and a list of loop closures, each any bytes; valid ones are evaluated.
#include "fuzz.h"
#include "loops/loops.h"
#include "truth/frame_times.h"
#include "truth/times.h"

using namespace vpr;
using fuzz::require;

namespace {

void judge(const LoopList& list, const Trajectory& trajectory, const LoopRules& rules) {
  const LoopJudgment judgment = judge_loops(list, trajectory, rules);
  require(judgment.has_loop.size() == trajectory.poses.size());
  require(judgment.loops.size() + judgment.repeated == list.loops.size());
  require(judgment.frames_found() <= judgment.frames_with_loop());
  for (const JudgedLoop& judged : judgment.loops) require(judged.loop.match < judged.loop.query);
}

}  // namespace

void fuzz::run(std::string_view input) {
  const auto folder = folder_of(split_parts(input));
  refuses([&] { read_time_list(folder / "times"); });
  for (const char* times : {"", "times"})
    refuses([&] {
      const Trajectory trajectory =
          read_trajectory(folder / "poses", *times == 0 ? "" : folder / times);
      require(trajectory.times_ns.empty() || trajectory.times_ns.size() == trajectory.poses.size());
      for (const LoopFrames frames : {LoopFrames::automatic, LoopFrames::index, LoopFrames::time}) {
        LoopListRules rules;
        rules.frames = frames;
        refuses([&] {
          const LoopList list = read_loop_list(folder / "loops", trajectory, rules);
          judge(list, trajectory, {{1}, {{}, 2}});
          judge(list, trajectory, {{0}, {kSecond, 0}});
        });
      }
    });
}
