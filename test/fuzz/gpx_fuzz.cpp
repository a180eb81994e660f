// Any bytes as a GPX track.
#include <cmath>

#include "fuzz.h"
#include "ground_truth/gps.h"
#include "ground_truth/gpx.h"

using namespace vpr;

void fuzz::run(std::string_view input) {
  const std::filesystem::path path = memory_file(input);
  refuses([&] {
    Trajectory track = read_gpx(path);
    require(!track.poses.empty() && track.lines.size() == track.poses.size());
    require(track.times_ns.empty() || track.times_ns.size() == track.poses.size());
    level(track);
    for (const auto& pose : track.poses)
      for (const double metres : pose->position) require(std::abs(metres) < 2e7);
    require(read_gpx(path.string() + "@:1").poses.size() == 1);
  });
}
