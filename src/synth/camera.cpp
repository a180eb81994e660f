#include "synth/camera.h"

#include <algorithm>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "synth/outside.h"

namespace vpr {
namespace {

constexpr int kMargin = 24;         // rendered around the picture, for the roll of the camera
constexpr double kNearestM = 0.25;  // of a wall

// How many metres of wall a pixel covers sideways.
double metres_per_pixel(const Canvas& canvas, const Wall& wall, const Column& column) {
  const Point way = wall_direction(wall.side);
  const Point normal{-way.y, way.x};
  const double towards = normal.x * column.ray.x + normal.y * column.ray.y;
  const double turn = (normal.x * canvas.right.x + normal.y * canvas.right.y) / towards;
  const double dx = canvas.right.x - turn * column.ray.x, dy = canvas.right.y - turn * column.ray.y;
  return std::abs(dx * way.x + dy * way.y) * column.depth / canvas.focal;
}

void cast_to_wall(const Canvas& canvas, const Scene& scene, const WallHit& hit, Column& column) {
  const auto index = static_cast<size_t>(hit.wall);
  column.depth = std::max(hit.distance, kNearestM);
  column.texels = column.depth / canvas.focal * kTexelsPerMetre;
  const Texture& texture = scene.walls[index];
  filter_strip(texture, choose_level(texture, column.texels), hit.along_m * kTexelsPerMetre,
               metres_per_pixel(canvas, scene.plan.walls[index], column) * kTexelsPerMetre,
               column.strip);
}

// What glass reflects: the wall that the ray meets next, as far away as both ways together.
void cast_mirrored(const Canvas& canvas, const Scene& scene, const WallHit& hit, Column& column) {
  constexpr double kBefore = 0.999;  // of the way to the glass, so that one starts in the room
  const Side side = scene.plan.walls[static_cast<size_t>(hit.wall)].side;
  const bool is_sideways = side == Side::right || side == Side::left;
  const Point back{is_sideways ? -column.ray.x : column.ray.x,
                   is_sideways ? column.ray.y : -column.ray.y};
  const Point from{canvas.position.x + column.ray.x * hit.distance * kBefore,
                   canvas.position.y + column.ray.y * hit.distance * kBefore};
  const auto next = cast_ray(scene.plan, from, back);
  if (!next) return;
  column.mirrored_depth = hit.distance + next->distance;
  const Texture& texture = scene.walls[static_cast<size_t>(next->wall)];
  const double texels = column.mirrored_depth / canvas.focal * kTexelsPerMetre;
  filter_strip(texture, choose_level(texture, texels), next->along_m * kTexelsPerMetre, texels,
               column.mirrored);
}

void cast_through_glass(const Canvas& canvas, const Scene& scene, const WallHit& hit,
                        Column& column) {
  const bool has_glass = (scene.far_view > 0 || scene.reflections > 0) &&
                         std::any_of(column.strip.begin(), column.strip.end(),
                                     [](const Texel& texel) { return texel[3] >= kGlassDaylight; });
  if (!has_glass) return;
  if (scene.far_view > 0)
    panorama_strip(scene.outside, column.ray, 1 / canvas.focal, column.outside);
  if (scene.reflections > 0) cast_mirrored(canvas, scene, hit, column);
}

}  // namespace

Camera make_camera(const World& world) {
  const auto width = static_cast<int>(world.image_width);
  return {width, static_cast<int>(world.image_height),
          width / 2.0 / std::tan(world.view_deg / 2 * kRadians)};
}

Canvas make_canvas(const Camera& camera, const CameraPose& pose) {
  const double heading = pose.heading_deg * kRadians;
  Canvas canvas;
  canvas.turned.create(camera.width + 2 * kMargin, camera.height + 2 * kMargin, CV_8UC3);
  canvas.focal = camera.focal_px;
  canvas.eye = pose.height_m;
  canvas.horizon = canvas.rows() / 2.0 +
                   camera.focal_px * std::tan(std::clamp(pose.pitch_deg, -40.0, 40.0) * kRadians);
  canvas.position = pose.position;
  canvas.forward = {std::cos(heading), std::sin(heading)};
  canvas.right = {std::sin(heading), -std::cos(heading)};
  return canvas;
}

std::vector<Column> cast_columns(const Canvas& canvas, const Scene& scene, int every) {
  std::vector<Column> columns(static_cast<size_t>((canvas.columns() + every - 1) / every));
  for (int i = 0; i < canvas.columns(); i += every) {
    Column& column = columns[static_cast<size_t>(i / every)];
    const double t = canvas.tangent(i);
    column.ray = {canvas.forward.x + t * canvas.right.x, canvas.forward.y + t * canvas.right.y};
    const auto hit = cast_ray(scene.plan, canvas.position, column.ray);
    cast_to_wall(canvas, scene, *hit, column);
    cast_through_glass(canvas, scene, *hit, column);
  }
  return columns;
}

cv::Mat upright(const Canvas& canvas, const Camera& camera, double roll_deg) {
  const double c = std::cos(roll_deg * kRadians), s = std::sin(roll_deg * kRadians);
  const double middle_x = canvas.columns() / 2.0, middle_y = canvas.rows() / 2.0;
  const double x0 = camera.width / 2.0, y0 = camera.height / 2.0;
  // From a pixel of the picture to (row, column) of the picture before, which lies on its side.
  const cv::Matx23d map(s, c, middle_y - s * x0 - c * y0, c, -s, middle_x - c * x0 + s * y0);
  cv::Mat picture;
  cv::warpAffine(canvas.turned, picture, map, {camera.width, camera.height},
                 cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  return picture;
}

}  // namespace vpr
