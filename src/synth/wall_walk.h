// A small stand-in for a recording: a camera that looks at corridor walls while it walks past, with
// known positions. Enough for a demonstration and for tests without any data set.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "base/monitor.h"

namespace vpr {

struct Walk {
  std::string name;
  bool is_query = false;
  uint64_t corridor = 0;  ///< which wall
  double from_m = 0;
  double to_m = 30;        ///< below from_m: walks the other way, seeing the same
  double speed_m_s = 1.2;  ///< varies by a twentieth on the way
  double brightness = 1;   ///< factor
  double noise = 4;        ///< standard deviation of grey values
};

template <class Visitor>
void visit_fields(Walk& walk, Visitor&& visit) {
  visit("name", walk.name);
  visit("is_query", walk.is_query);
  visit("corridor", walk.corridor);
  visit("from_m", walk.from_m);
  visit("to_m", walk.to_m);
  visit("speed_m_s", walk.speed_m_s);
  visit("brightness", walk.brightness);
  visit("noise", walk.noise);
}

struct World {
  std::string name;
  uint64_t seed = 1;
  uint64_t corridors = 2;
  double corridor_length_m = 40;
  double frames_per_s = 8;
  double same_place_m = 0.5;  ///< frames at most so far apart show the same place
  std::vector<Walk> walks;
};

/// All but the walks.
template <class Visitor>
void visit_fields(World& world, Visitor&& visit) {
  visit("name", world.name);
  visit("seed", world.seed);
  visit("corridors", world.corridors);
  visit("corridor_length_m", world.corridor_length_m);
  visit("frames_per_s", world.frames_per_s);
  visit("same_place_m", world.same_place_m);
}

/// Throws Error(input) if it can't be read, Error(usage) if it is no world (vpr.world/1) or a value
/// is out of range.
World read_world(const std::filesystem::path& path);

/// Whether a folder holds what write_world writes, and nothing else.
bool is_world_folder(const std::filesystem::path& folder);

/// Positions along the wall, in metres, frame by frame.
std::vector<double> walk_positions(const World& world, const Walk& walk);

/// Frame `index` of a walk: 160x120, grey. Depends on the world, the walk and the index alone.
cv::Mat render_frame(const World& world, const Walk& walk, const cv::Mat& wall, size_t index,
                     double position_m);

/// The painted wall of a corridor: doors, posters, boards, lockers and lamps from the seed.
cv::Mat paint_wall(const World& world, uint64_t corridor);

/// Writes a folder of frames and a positions.csv for every walk, ground_truth.csv (pairs of query
/// and training frames) for every query, and dataset.json, into an existing folder.
/// Byte-identical for a world, on any number of threads.
void write_world(const World& world, const std::filesystem::path& folder, const Monitor& monitor);

}  // namespace vpr
