// Painted surfaces: textures and how they are looked up without flicker from near and far, the
// brush for walls, and paint, bricks, tiles and wear.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "base/random.h"
#include "synth/floor_plan.h"

namespace vpr {

inline constexpr int kTexelsPerMetre = 128;     ///< of walls and people, on level 0
inline constexpr int kPlanTexelsPerMetre = 64;  ///< of floors and ceilings, on level 0

/// Levels of halved size. Pixels are blue, green, red and a fourth value: of walls, how much
/// daylight comes through (255: all of it, no lamp light); of people, how much they cover.
///
/// Walls and people are stored turned: a row is one vertical strip, from the top down, so that what
/// a column of the picture needs lies together. Floors and ceilings are as on the plan.
struct Texture {
  std::vector<cv::Mat> levels;
};

/// Halves until a side is a texel long.
Texture make_texture(const cv::Mat& level_0);

/// Turns a picture as people see it into a wall's strips.
Texture make_wall_texture(const cv::Mat& picture);

/// The level at which a texel is about as large as a pixel, where one pixel covers `texels` of
/// level 0.
size_t choose_level(const Texture& texture, double texels);

/// One vertical strip: the mean over `width` texels around `centre` (both of level 0, the width at
/// least one of the chosen level's), clamped at the ends. `strip` gets as many pixels as a row of
/// the level has.
void filter_strip(const Texture& texture, size_t level, double centre, double width,
                  std::vector<cv::Vec4b>& strip);

/// Paints onto the picture of a wall, in metres from its left end and from the floor.
///
/// Two sources of chance: `style` says what stands where and in which colour, and is the same for
/// walls that resemble each other; `detail` is the writing, sheets and scratches, which never are.
struct WallBrush {
  cv::Mat& picture;  ///< 8 bits, blue, green, red, daylight; top row at kRoomHeightM
  RandomEngine style;
  RandomEngine detail;
  double left_m = 0;        ///< of the slot to furnish
  bool is_bare = false;     ///< nothing hangs or stands in the slot but doors and windows
  bool is_changed = false;  ///< the slot is otherwise on this day, in what `day` draws
  RandomEngine day{};

  /// Where an area is in the picture. It may reach over the ends of the wall.
  cv::Rect area(double x, double bottom, double width, double height) const;
  /// Fills an area, as far as it is on the wall; an empty one is left out.
  void fill(double x, double bottom, double width, double height, const cv::Scalar& colour);
  /// A frame around a filled area, with a shadow below and to its right, so that things do not look
  /// painted on.
  void fill_framed(double x, double bottom, double width, double height, const cv::Scalar& inside,
                   const cv::Scalar& frame, double frame_m);
  /// One line of text, whose capitals are `height` metres high.
  void put_text(double x, double bottom, double height, const std::string& text,
                const cv::Scalar& ink, int thickness);
  /// Lines of letters that fill the area, `line_m` apart.
  void write(double x, double bottom, double width, double height, double line_m,
             const cv::Scalar& ink);
};

/// Metres on a wall as texels of its level 0, rounded.
int wall_texels(double metres);

/// True with a probability.
bool chance(RandomEngine& engine, double probability);

/// Uniform in [low, high).
double between(RandomEngine& engine, double low, double high);

/// A colour of daylight share 0.
cv::Scalar colour(double blue, double green, double red);

/// A colour of daylight share 0, with each channel uniform in [low, high).
cv::Scalar any_colour(RandomEngine& engine, double low, double high);

/// A colour with each channel multiplied by a factor, which may exceed 1.
cv::Scalar darker(const cv::Scalar& colour, double factor);

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
