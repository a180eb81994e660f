// Any bytes as a world of vpr-synth; of one that is accepted, plans, walks and all texts.
#include "fuzz.h"
#include "synth/recording_truth.h"

using namespace vpr;

namespace {

constexpr double kMostPlanM = 30;  // of a room that is worth the time of a plan
constexpr size_t kMostPoses = 200;

bool is_small(const World& world) {
  size_t rooms = 0;
  for (const Floor& floor : world.floors) {
    rooms += floor.rooms.size();
    for (const Room& room : floor.rooms)
      if (room.width > kMostPlanM || room.depth > kMostPlanM) return false;
  }
  size_t poses = 0;
  for (const Walk& walk : world.walks) {
    const double metres = Path(walk.path).length_m();
    poses += walk.frames > 0 ? walk.frames
                             : static_cast<size_t>(metres / walk.speed_m_s * world.fps) + 1;
  }
  return rooms < 20 && poses < kMostPoses;
}

}  // namespace

void fuzz::run(std::string_view input) {
  const World world = read_world(memory_file(input));
  if (is_small(world)) recording_texts(world, record_walks(world));
}
