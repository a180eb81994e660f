// What stands and hangs on the walls: doors, boards, posters, lockers, radiators, windows.
#pragma once

#include <cstdint>

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
  double left_m = 0;  ///< of the slot to furnish

  cv::Rect area(double x, double bottom, double width, double height) const;
  void fill(double x, double bottom, double width, double height, const cv::Scalar& colour);
  /// Lines of letters that fill the area, `line_m` apart.
  void write(double x, double bottom, double width, double height, double line_m,
             const cv::Scalar& ink);
};

/// Uniform in [low, high).
double between(RandomEngine& engine, double low, double high);

/// A colour of daylight share 0.
cv::Scalar colour(double blue, double green, double red);

inline constexpr double kSlotM = 2;  ///< walls are furnished slot by slot

/// One slot of a wall. In halls there are fewer doors and larger boards.
void furnish_slot(WallBrush& brush, bool is_hall, bool has_windows);

/// The frames of a glass front, and what one sees through it, over the whole picture.
void paint_glass_front(WallBrush& brush);

}  // namespace vpr
