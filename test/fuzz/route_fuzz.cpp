// Any bytes as poses, places and walls of a data set.
#include "base/monitor.h"
#include "fuzz.h"
#include "truth/positions.h"

void vpr::fuzz::run(std::string_view input) {
  const std::filesystem::path path = memory_file(input);
  refuses([&] { read_pose_csv(path); });
  refuses([&] { read_pose_csv(path.string() + "@1:9:2", 4); });
  refuses([&] { read_traveled(path, {"", 3}); });
  refuses([&] { read_place_positions(path); });
  refuses([&] { read_walls(path); });
}
