// A camera on the floor plan: it casts one ray per image column to a strip of wall, with automatic
// exposure, blur and sensor noise.
#pragma once

#include <algorithm>
#include <array>
#include <numbers>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "base/random.h"
#include "synth/scene.h"
#include "synth/walking.h"
#include "synth/world.h"

namespace vpr {

/// A pinhole camera: image size and focal length in pixels.
struct Camera {
  int width = 640;
  int height = 480;
  double focal_px = 493;
};

/// The camera of all sequences of a world. World::view_deg is the horizontal angle of view.
Camera make_camera(const World& world);

inline constexpr double kRadians = std::numbers::pi / 180;  ///< per degree

/// A pixel of a Texture.
using Texel = cv::Vec4b;

/// The image before roll and noise, transposed: each row is one column of pixels from top to
/// bottom.
struct Canvas {
  cv::Mat turned;  ///< CV_8UC3: blue, green, red
  double focal;    ///< pixels
  double horizon;  ///< row of the horizon
  double eye;      ///< meters above the floor
  Point position;
  Point forward;  ///< unit vector on the floor, as is `right`
  Point right;

  int columns() const { return turned.rows; }
  int rows() const { return turned.cols; }
  double tangent(int column) const { return (column + 0.5 - columns() / 2.0) / focal; }
};

/// The wall that one column of pixels shows.
struct Column {
  Point ray;                    ///< length 1 along the camera's axis, so that distances are depths
  double depth = 0;             ///< meters, along the camera's axis
  double texels = 0;            ///< vertical texels of the wall's level 0 per pixel
  std::vector<Texel> strip;     ///< of the wall, from top to bottom
  std::vector<Texel> outside;   ///< of the panorama outside the glass, from top to bottom; or empty
  std::vector<Texel> mirrored;  ///< of the wall reflected in the glass; or empty
  double mirrored_depth = 0;    ///< meters, along the camera's axis
};

/// An empty canvas for a camera pose, with a margin on every side for the camera's roll. Pitch is
/// limited to 40 degrees.
Canvas make_canvas(const Camera& camera, const CameraPose& pose);

/// Every `every`th column of a canvas, from left to right. The camera must be in an open cell of
/// the plan.
std::vector<Column> cast_columns(const Canvas& canvas, const Scene& scene, int every = 1);

/// The canvas as an upright image, rotated by the camera's roll (degrees, clockwise) and cropped.
cv::Mat upright(const Canvas& canvas, const Camera& camera, double roll_deg);

/// Factors in units of 1/256 for texels lit by lamps and by daylight: blue, green, red.
struct Light {
  std::array<int, 3> lamps{};
  std::array<int, 3> day{};
};

inline constexpr int kMeteredColumns = 16;  ///< one of this many columns of an image is metered

/// The mean brightness of a canvas in gray values before exposure, estimated from some columns.
double metered_brightness(const Canvas& canvas, const std::vector<const Column*>& columns,
                          const Conditions& conditions);

/// The light under automatic exposure for a metered `brightness`; the target is a fixed mean gray
/// value. `drift` is a factor on the exposure.
Light make_light(double brightness, const Conditions& conditions, double drift);

/// Converts a texel (blue, green, red, daylight share of 255) to the gray values of a pixel.
inline void shine(const std::array<int, 4>& texel, const Light& light, std::array<int, 3>& out) {
  for (size_t c = 0; c < 3; ++c) {
    const int factor = light.lamps[c] + ((light.day[c] - light.lamps[c]) * texel[3] >> 8);
    out[c] = std::min(255, texel[c] * factor >> 8);
  }
}

inline constexpr double kShutterS = 1.0 / 50;  ///< the default

/// Motion blur for the movement of the image during the exposure, in pixels.
void blur_by_turning(cv::Mat& picture, double sideways, double upwards);

/// Adds normal noise with this standard deviation in gray values to every channel of every pixel.
void add_noise(cv::Mat& picture, double deviation, RandomEngine& engine);

}  // namespace vpr
