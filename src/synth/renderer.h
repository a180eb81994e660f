// Renders a scene from a camera pose: one ray per image column hits the floor plan; the column
// shows the strip of wall there, with floor and ceiling below and above.
#pragma once

#include <vector>

#include "base/random.h"
#include "synth/people.h"
#include "synth/scene.h"

namespace cv {
class Mat;
}

namespace vpr {

/// A pinhole camera: image size and focal length in pixels.
struct Camera {
  int width = 640;
  int height = 480;
  double focal_px = 493;
};

/// The camera of all sequences of a world.
Camera make_camera(const World& world);

/// The visible world at one moment.
struct View {
  const Scene& scene;
  const std::vector<PersonImages>& people;
  std::vector<Figure> figures;
  CameraPose pose;
  Conditions conditions;
  std::vector<CameraPose> metered;  ///< input of the automatic exposure; empty: only `pose`
};

/// BGR, 8 bits, with automatic exposure, motion blur and sensor noise. `noise_engine` draws the
/// noise; everything else depends only on the view. The camera must be in an open cell.
cv::Mat render(const Camera& camera, const View& view, RandomEngine noise_engine);

}  // namespace vpr
