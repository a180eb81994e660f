// Any bytes as a world of vpr-synth; for valid ones, plans, walks and all texts.
#include <algorithm>

#include "fuzz.h"
#include "synth/recording.h"

using namespace vpr;

namespace {

constexpr double kMaxPlanM = 30;  // maximum size of a room, to limit the time
constexpr double kMaxPoses = 200;

double most_poses(const World& world, const Walk& walk) {
  if (walk.frames > 0) return static_cast<double>(walk.frames);
  double slowest = walk.speed_m_s;
  for (const WalkPace& pace : walk.paces) slowest = std::min(slowest, pace.speed_m_s);
  double seconds = Path(walk.path).length_m() * static_cast<double>(walk.cuts.size() + 1) / slowest;
  for (const WalkStop& stop : walk.stops) seconds += stop.seconds;
  return seconds * world.fps + 1;
}

bool is_small(const World& world) {
  size_t rooms = 0;
  for (const Floor& floor : world.floors) {
    rooms += floor.rooms.size();
    for (const Room& room : floor.rooms)
      if (room.width > kMaxPlanM || room.depth > kMaxPlanM) return false;
  }
  double poses = 0;
  for (const Walk& walk : world.walks) poses += most_poses(world, walk);
  return rooms < 20 && poses < kMaxPoses;
}

}  // namespace

void fuzz::run(std::string_view input) {
  const World world = read_world(memory_file(input));
  if (is_small(world)) recording_texts(world, record_walks(world));
}
