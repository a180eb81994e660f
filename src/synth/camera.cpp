#include "synth/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <opencv2/imgproc.hpp>

#include "synth/scene.h"

namespace vpr {
namespace {

constexpr int kMargin = 24;         // rendered around the image, for the roll of the camera
constexpr double kNearestM = 0.25;  // minimum distance to a wall

// Meters of wall per pixel in horizontal direction.
double meters_per_pixel(const Canvas& canvas, const Wall& wall, const Column& column) {
  const Point way = wall_direction(wall.side);
  const Point normal{-way.y, way.x};
  const double toward = normal.x * column.ray.x + normal.y * column.ray.y;
  const double turn = (normal.x * canvas.right.x + normal.y * canvas.right.y) / toward;
  const double dx = canvas.right.x - turn * column.ray.x, dy = canvas.right.y - turn * column.ray.y;
  return std::abs(dx * way.x + dy * way.y) * column.depth / canvas.focal;
}

void cast_to_wall(const Canvas& canvas, const Scene& scene, const WallHit& hit, Column& column) {
  const auto index = static_cast<size_t>(hit.wall);
  column.depth = std::max(hit.distance, kNearestM);
  column.texels = column.depth / canvas.focal * kTexelsPerMeter;
  const Texture& texture = scene.walls[index];
  filter_strip(texture, choose_level(texture, column.texels), hit.along_m * kTexelsPerMeter,
               meters_per_pixel(canvas, scene.plan.walls[index], column) * kTexelsPerMeter,
               column.strip);
}

// The reflection in glass: the next wall that the reflected ray hits, at the depth of both paths
// together.
void cast_mirrored(const Canvas& canvas, const Scene& scene, const WallHit& hit, Column& column) {
  // share of the way to the glass, so that the reflected ray starts inside the room
  constexpr double kBefore = 0.999;
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
  const double texels = column.mirrored_depth / canvas.focal * kTexelsPerMeter;
  filter_strip(texture, choose_level(texture, texels), next->along_m * kTexelsPerMeter, texels,
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

constexpr double kMeanBrightness = 112;  // target of the automatic exposure
constexpr double kDaylightBrightness = 1.5;

double brightness(const Texel& texel, const Conditions& conditions) {
  const double day = texel[3] / 255.0;
  return (texel[0] + texel[1] + texel[2]) / 3.0 *
         (day * conditions.daylight * kDaylightBrightness + (1 - day) * conditions.lamps);
}

constexpr int kMaxBlur = 31;
constexpr size_t kNoiseValues = size_t{1} << 16;
constexpr int kNoiseUnit = 64;  // one standard deviation

// Sums of twelve uniform numbers: nearly normal, and the same on every machine.
const std::array<int16_t, kNoiseValues>& noise_values() {
  static const auto kValues = [] {
    std::array<int16_t, kNoiseValues> values;
    RandomEngine engine = named_engine(0, "sensor noise");
    for (int16_t& value : values) {
      double sum = -6;
      for (int i = 0; i < 12; ++i) sum += uniform_unit(engine);
      value = static_cast<int16_t>(std::lround(sum * kNoiseUnit));
    }
    return values;
  }();
  return kValues;
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
  // Maps a pixel of the image to (row, column) of the transposed canvas.
  const cv::Matx23d map(s, c, middle_y - s * x0 - c * y0, c, -s, middle_x - c * x0 + s * y0);
  cv::Mat picture;
  cv::warpAffine(canvas.turned, picture, map, {camera.width, camera.height},
                 cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  return picture;
}

double metered_brightness(const Canvas& canvas, const std::vector<const Column*>& columns,
                          const Conditions& conditions) {
  constexpr double kFloorAndCeiling = 110;
  double sum = 0;
  for (const Column* column : columns) {
    double wall = 0;
    for (const Texel& texel : column->strip) wall += std::min(255.0, brightness(texel, conditions));
    wall /= static_cast<double>(column->strip.size());
    const double share = std::min(1.0, kRoomHeightM * canvas.focal / column->depth / canvas.rows());
    sum += share * wall + (1 - share) * kFloorAndCeiling * conditions.lamps;
  }
  return sum / static_cast<double>(columns.size());
}

Light make_light(double brightness, const Conditions& conditions, double drift) {
  const double gain =
      std::clamp(std::pow(kMeanBrightness / std::max(brightness, 1.0), 0.8), 0.3, 3.0) *
      conditions.exposure * drift * 256;
  const std::array<double, 3> balance = {1 - 0.14 * conditions.warmth, 1.0,
                                         1 + 0.14 * conditions.warmth};
  const std::array<double, 3> sky = {1.06, 1.0, 0.96};
  Light light;
  for (size_t c = 0; c < 3; ++c) {
    const double limit = 30000;
    light.lamps[c] =
        static_cast<int>(std::lround(std::min(limit, gain * conditions.lamps * balance[c])));
    light.day[c] = static_cast<int>(std::lround(
        std::min(limit, gain * conditions.daylight * kDaylightBrightness * balance[c] * sky[c])));
  }
  return light;
}

void blur_by_turning(cv::Mat& picture, double sideways, double upwards) {
  const auto odd = [](double pixels) {  // an odd size shifts nothing
    const double way = std::min<double>(kMaxBlur, std::abs(pixels));
    return 2 * static_cast<int>(std::lround((way - 1) / 2)) + 1;
  };
  const cv::Size size(std::max(1, odd(sideways)), std::max(1, odd(upwards)));
  if (size.area() > 1) cv::blur(picture, picture, size);
}

void add_noise(cv::Mat& picture, double deviation, RandomEngine& engine) {
  const auto& values = noise_values();
  const int factor = static_cast<int>(std::lround(deviation * 256));
  const size_t bytes = static_cast<size_t>(picture.cols) * 3;
  for (int y = 0; y < picture.rows; ++y) {
    uint8_t* row = picture.ptr<uint8_t>(y);
    size_t from = engine();  // each row uses another part of the values
    for (size_t i = 0; i < bytes; ++i) {
      const int noise = values[(from + i) % kNoiseValues] * factor / (256 * kNoiseUnit);
      row[i] = cv::saturate_cast<uint8_t>(row[i] + noise);
    }
  }
}

}  // namespace vpr
