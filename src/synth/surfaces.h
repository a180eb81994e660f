// Painted surfaces: textures with filtered look-up, the brush for walls, and paint, bricks, tiles
// and wear.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "base/random.h"
#include "synth/floor_plan.h"

namespace vpr {

inline constexpr int kTexelsPerMeter = 128;     ///< of walls and people, on level 0
inline constexpr int kPlanTexelsPerMeter = 64;  ///< of floors and ceilings, on level 0

/// Levels of halved size (a mipmap). Pixels are blue, green, red and a fourth value: for walls, the
/// transmitted daylight (255: only daylight, no lamp light); for people, the coverage.
///
/// Walls and people are stored transposed: a row is one vertical strip from top to bottom, so that
/// the pixels for one image column are contiguous. Floors and ceilings have the orientation of the
/// plan.
struct Texture {
  std::vector<cv::Mat> levels;
};

/// Halves the size until one side is a single texel.
Texture make_texture(const cv::Mat& level_0);

/// Transposes an upright image to the strips of a wall.
Texture make_wall_texture(const cv::Mat& picture);

/// The level whose texels are about as large as a pixel, if one pixel covers `texels` of level 0.
size_t choose_level(const Texture& texture, double texels);

/// One vertical strip: the mean over `width` texels around `center` (both in texels of level 0, the
/// width at least one texel of the chosen level), clamped at the ends. `strip` has as many pixels
/// as a row of the level.
void filter_strip(const Texture& texture, size_t level, double center, double width,
                  std::vector<cv::Vec4b>& strip);

/// The distant surroundings of a building in daylight, without parallax: sky, houses, trees and
/// ground. It has the layout of a wall's texture: strips go once around by azimuth, and cover
/// tangents of elevation from 1 to -1.
Texture make_panorama(uint64_t seed);

/// The strip of a panorama in a direction (any length > 0), for pixels `pixel_rad` wide.
void panorama_strip(const Texture& panorama, Point direction, double pixel_rad,
                    std::vector<cv::Vec4b>& strip);

/// Paints onto the image of a wall, in meters from its left end and from the floor.
///
/// Random engines: `style` chooses objects, positions and colors, and is the same for similar
/// walls; `detail` draws text, sheets and scratches, which always differ.
struct WallBrush {
  cv::Mat& picture;  ///< 8 bits, blue, green, red, daylight; top row at kRoomHeightM
  RandomEngine style;
  RandomEngine detail;
  double left_m = 0;        ///< of the slot to furnish
  bool is_bare = false;     ///< the slot has only doors and windows
  bool is_changed = false;  ///< the objects drawn with `day` differ on this day
  RandomEngine day{};

  /// The pixels of an area, which may extend beyond the ends of the wall.
  cv::Rect area(double x, double bottom, double width, double height) const;
  /// The visible part of the image in an area; may be empty.
  cv::Mat part(double x, double bottom, double width, double height) const;
  /// Fills the visible part of an area, if any.
  void fill(double x, double bottom, double width, double height, const cv::Scalar& color);
  /// A framed area with a shadow below and to its right, which makes objects look
  /// three-dimensional.
  void fill_framed(double x, double bottom, double width, double height, const cv::Scalar& inside,
                   const cv::Scalar& frame, double frame_m);
  /// One line of text; its capitals are `height` meters high.
  void put_text(double x, double bottom, double height, const std::string& text,
                const cv::Scalar& ink, int thickness);
  /// Lines of letters that fill the area, `line_m` apart.
  void write(double x, double bottom, double width, double height, double line_m,
             const cv::Scalar& ink);
};

/// Meters on a wall as texels of its level 0, rounded.
int wall_texels(double meters);

/// True with this probability; and uniform in [low, high).
bool chance(RandomEngine& engine, double probability);
double between(RandomEngine& engine, double low, double high);

/// A color of daylight share 0; the same with each channel uniform in [low, high); and a color of
/// daylight alone, or of full coverage.
cv::Scalar color(double blue, double green, double red);
cv::Scalar any_color(RandomEngine& engine, double low, double high);
cv::Scalar opaque(double blue, double green, double red);

/// A color with each channel multiplied by a factor, which may exceed 1.
cv::Scalar darker(const cv::Scalar& color, double factor);

/// Names of a floor and of the floor whose plan it uses.
struct FloorNames {
  std::string own;
  std::string plan;
};

struct Finish {
  cv::Scalar plaster;
  cv::Scalar dado;    ///< the lower part of a wall
  double dado_m = 0;  ///< height of the dado; 0: none
  bool brick_halls = false;
  double flooring = 1;  ///< factor of the flooring's brightness
  double flooring_tile_m = 0.6;
  bool has_runner = false;  ///< a dark border along the flooring's edges
  double ceiling = 1;       ///< factor of the ceiling's brightness
  bool has_slats = false;   ///< on the ceiling, instead of tiles alone
  double lamps = 1;         ///< factor of the lamps' brightness
};

/// The finish of one room; the common finish of the floor if variety.finishes is 0.
Finish room_finish(const World& world, const FloorNames& names, size_t room);

/// The room at a point, halls before corridors; the first room if there is none.
size_t room_at(const Floor& floor, Point point);

/// Paints bricks over the whole image of a wall.
void lay_bricks(WallBrush& brush, double length_m);

/// Paints plaster and dado between two points of a wall, in meters from its left end.
void plaster(WallBrush& brush, const Finish& finish, double from_m, double to_m);

/// Adds speckle and stains: `fine` gray values per texel, `coarse` over decimeters.
void roughen(cv::Mat& picture, RandomEngine& engine, int fine, double coarse);

/// Adds faded and repaired paint, and scuffs near the floor; `wear` from 0 (none) to 1.
void wear_wall(WallBrush& brush, double length_m, double wear, RandomEngine& engine);

/// Paints tiles over a part of the image of a plan, with sides of `texels`.
void lay_tiles(cv::Mat& picture, const cv::Rect& part, int texels, RandomEngine& engine,
               const cv::Scalar& base, double spread, const cv::Scalar& joint);

inline constexpr double kSlotM = 2;  ///< width of the slots in which walls are furnished

/// Furnishes one slot of a wall. Halls have fewer doors and larger boards.
void furnish_slot(WallBrush& brush, bool is_hall, bool has_windows);

/// Paints the frames of a glass front and the view through it over the whole image.
void paint_glass_front(WallBrush& brush);

}  // namespace vpr
