// Paint, flooring and ceilings: what a building has throughout, and what a room has instead.
#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

#include "synth/floor_plan.h"
#include "synth/wall_brush.h"

namespace vpr {

/// Names of the two floors that matter: the own one, and the one whose plan it has.
struct FloorNames {
  std::string own;
  std::string plan;
};

/// How walls, floor and ceiling look.
struct Finish {
  cv::Scalar plaster;
  cv::Scalar dado;    ///< the lower part of a wall
  double dado_m = 0;  ///< up to this height; 0: none
  bool brick_halls = false;
  double flooring = 1;  ///< factor of the flooring's brightness
  double flooring_tile_m = 0.6;
  bool has_runner = false;  ///< a dark border along the flooring's edges
  double ceiling = 1;       ///< factor of the ceiling's brightness
  bool has_slats = false;   ///< on the ceiling, instead of tiles alone
  double lamps = 1;         ///< factor of the lamps' brightness
};

/// What a floor has throughout.
Finish building_finish(const World& world, const FloorNames& names);

/// What one room of a floor has; with variety.finishes at 0 the building's.
Finish room_finish(const World& world, const FloorNames& names, size_t room);

/// The room at a point, halls before corridors; the first if there is none.
size_t room_at(const Floor& floor, Point point);

/// Bricks over the whole picture of a wall.
void lay_bricks(WallBrush& brush, double length_m);

/// Plaster and dado between two points of a wall, in metres from its left end.
void plaster(WallBrush& brush, const Finish& finish, double from_m, double to_m);

/// Speckle and stains: `fine` grey values from texel to texel, `coarse` over decimetres.
void roughen(cv::Mat& picture, RandomEngine& engine, int fine, double coarse);

/// Faded and mended paint, and scuffs near the floor; `wear` from 0 (nothing) to 1.
void wear_wall(WallBrush& brush, double length_m, double wear, RandomEngine& engine);

/// Tiles over a part of a plan's picture, with sides of `texels`.
void lay_tiles(cv::Mat& picture, const cv::Rect& part, int texels, RandomEngine& engine,
               const cv::Scalar& base, double spread, const cv::Scalar& joint);

}  // namespace vpr
