// Where a camera looks on the floor plan: a ray for each column of its picture, and the strip of
// wall that the ray hits.
#pragma once

#include <numbers>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "synth/scene.h"
#include "synth/walking.h"

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

}  // namespace vpr
