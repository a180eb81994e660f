// A brush for the pictures of walls, in metres, and colours drawn by chance.
#pragma once

#include <string>

#include <opencv2/core/mat.hpp>

#include "base/random.h"

namespace vpr {

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

}  // namespace vpr
