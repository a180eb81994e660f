// The appearance of a floor on one day (painted walls, flooring and ceiling, and the panorama
// outside its windows), and its image from a camera pose: one ray per image column hits the floor
// plan; the column shows the strip of wall there, with floor and ceiling below and above.
#pragma once

#include <vector>

#include "base/monitor.h"
#include "base/random.h"
#include "synth/floor_plan.h"
#include "synth/surfaces.h"
#include "synth/walking.h"

namespace cv {
class Mat;
}

namespace vpr {

/// Texels of a wall with at least this daylight share are transparent.
inline constexpr int kGlassDaylight = 200;

struct Scene {
  FloorPlan plan;
  std::vector<Texture> walls;  ///< as plan.walls
  Texture floor;               ///< kPlanTexelsPerMeter from plan.origin, rows upwards
  Texture ceiling;
  Texture outside;         ///< a panorama; empty with far_view 0
  double far_view = 0;     ///< as in BuildingVariety
  double reflections = 0;  ///< as in BuildingVariety
};

/// Whether a wall has windows: some of the walls that face the outside do.
bool has_windows(const World& world, const FloorNames& names, const FloorPlan& plan, size_t wall);

/// A floor on one day; depends only on the world, the floor's index and the day. Walls are painted
/// in parallel.
Scene make_scene(const World& world, size_t floor, const Monitor& monitor, uint64_t day = 0);

/// A pinhole camera: image size and focal length in pixels.
struct Camera {
  int width = 640;
  int height = 480;
  double focal_px = 493;
};

Camera make_camera(const World& world);

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
