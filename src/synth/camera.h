// A camera on the floor plan: a ray for each column of its picture and the strip of wall that the
// ray hits; automatic exposure; and what the sensor adds.
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

/// A pinhole camera: the size of its pictures and its focal length, all in pixels.
struct Camera {
  int width = 640;
  int height = 480;
  double focal_px = 493;
};

/// The camera of all walks of a world: `view_deg` is the angle that its pictures are wide.
Camera make_camera(const World& world);

inline constexpr double kRadians = std::numbers::pi / 180;  ///< in a degree

/// A pixel of a Texture.
using Texel = cv::Vec4b;

/// The picture before roll and noise, one row a column of pixels, from the top down.
struct Canvas {
  cv::Mat turned;  ///< CV_8UC3: blue, green, red
  double focal;    ///< pixels
  double horizon;  ///< row of the eye's height
  double eye;      ///< metres above the floor
  Point position;
  Point forward;  ///< of length 1, on the floor, as `right`
  Point right;

  int columns() const { return turned.rows; }
  int rows() const { return turned.cols; }
  double tangent(int column) const { return (column + 0.5 - columns() / 2.0) / focal; }
};

/// What one column of pixels sees of the wall in front of it.
struct Column {
  Point ray;                    ///< length 1 along the camera's axis, so that distances are depths
  double depth = 0;             ///< metres, along the camera's axis
  double texels = 0;            ///< of the wall's level 0 in a pixel, upwards
  std::vector<Texel> strip;     ///< of the wall, from its top down
  std::vector<Texel> outside;   ///< of the panorama behind glass, from its top down; or empty
  std::vector<Texel> mirrored;  ///< of the wall that glass reflects; or empty
  double mirrored_depth = 0;    ///< metres, along the camera's axis
};

/// An empty canvas for a camera in a pose. It is a margin larger than the picture on every side,
/// for the camera's roll. Pitches beyond 40 degrees count as 40.
Canvas make_canvas(const Camera& camera, const CameraPose& pose);

/// Every `every`th column of a canvas, from left to right. Its position must be in an open cell of
/// the plan.
std::vector<Column> cast_columns(const Canvas& canvas, const Scene& scene, int every = 1);

/// The canvas turned upright by the camera's roll (degrees, clockwise), cut to the picture's size.
cv::Mat upright(const Canvas& canvas, const Camera& camera, double roll_deg);

/// Factors of 256 by which lamp-lit and daylit texels are multiplied: blue, green, red.
struct Light {
  std::array<int, 3> lamps{};
  std::array<int, 3> day{};
};

inline constexpr int kMeteredColumns = 16;  ///< every so manieth column of a picture is metered

/// How bright a canvas is, in grey values before exposure, by some of its columns.
double metered_brightness(const Canvas& canvas, const std::vector<const Column*>& columns,
                          const Conditions& conditions);

/// The light under automatic exposure that was metered to `brightness`, and aims at a mean grey
/// value. `drift` is a factor of that exposure.
Light make_light(double brightness, const Conditions& conditions, double drift);

/// Turns a texel (blue, green, red, daylight share of 255) into the grey values of a pixel.
inline void shine(const std::array<int, 4>& texel, const Light& light, std::array<int, 3>& out) {
  for (size_t c = 0; c < 3; ++c) {
    const int factor = light.lamps[c] + ((light.day[c] - light.lamps[c]) * texel[3] >> 8);
    out[c] = std::min(255, texel[c] * factor >> 8);
  }
}

inline constexpr double kShutterS = 1.0 / 50;  ///< where no other time is stated

/// Blurs by the way that the picture moves while the shutter is open, in pixels.
void blur_by_turning(cv::Mat& picture, double sideways, double upwards);

/// Adds normal noise of a standard deviation in grey values to every channel of every pixel.
void add_noise(cv::Mat& picture, double deviation, RandomEngine& engine);

}  // namespace vpr
