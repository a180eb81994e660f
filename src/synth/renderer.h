// From a scene and a camera pose to a picture: a ray for each column of the picture, over the floor
// plan, then the strip of wall that it hits, and floor and ceiling above and below.
#pragma once

#include <vector>

#include "base/random.h"
#include "synth/camera.h"
#include "synth/people.h"
#include "synth/scene.h"

namespace cv {
class Mat;
}

namespace vpr {

/// What there is to see at one moment.
struct View {
  const Scene& scene;
  const std::vector<Looks>& cast;
  std::vector<Figure> figures;
  CameraPose pose;
  Conditions conditions;
  std::vector<CameraPose> metered;  ///< what the automatic exposure follows; empty: `pose` alone
};

/// BGR, 8 bits, with automatic exposure, motion blur and sensor noise. The noise is drawn from
/// `noise_engine`; all else depends on the view alone. The camera must stand in an open cell.
cv::Mat render(const Camera& camera, const View& view, RandomEngine noise_engine);

}  // namespace vpr
