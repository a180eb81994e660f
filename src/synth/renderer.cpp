#include "synth/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "synth/camera.h"
#include "synth/scene.h"

namespace vpr {
namespace {

constexpr double kNearestFigureM = 0.5;

/// One image row of floor or ceiling: all its pixels have the same depth.
struct PlaneRow {
  double depth = 0;
  size_t level = 0;
};

std::array<int, 4> mix(const Texel& a, const Texel& b, int share_b) {  // share of 256
  std::array<int, 4> mixed;
  for (int c = 0; c < 4; ++c)
    mixed[static_cast<size_t>(c)] = (a[c] * (256 - share_b) + b[c] * share_b) >> 8;
  return mixed;
}

// The wall's strip at a height, in texels of the strip from its top.
std::array<int, 4> sample_strip(const std::vector<Texel>& strip, double from_top) {
  const double at = std::clamp(from_top - 0.5, 0.0, static_cast<double>(strip.size() - 1));
  const auto first = static_cast<size_t>(at);
  const size_t second = std::min(first + 1, strip.size() - 1);
  return mix(strip[first], strip[second],
             static_cast<int>((at - static_cast<double>(first)) * 256));
}

std::array<int, 4> sample_plane(const Texture& texture, const FloorPlan& plan, size_t level,
                                Point point) {
  const cv::Mat& image = texture.levels[level];
  const double scale = static_cast<double>(kPlanTexelsPerMeter >> level);
  const double x = std::clamp((point.x - plan.origin.x) * scale - 0.5, 0.0, image.cols - 1.001);
  const double y = std::clamp((point.y - plan.origin.y) * scale - 0.5, 0.0, image.rows - 1.001);
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  const int fx = static_cast<int>((x - column) * 256), fy = static_cast<int>((y - row) * 256);
  const auto* upper = image.ptr<Texel>(row) + column;
  const auto* lower = image.ptr<Texel>(std::min(row + 1, image.rows - 1)) + column;
  const int next = column + 1 < image.cols ? 1 : 0;
  const auto a = mix(upper[0], upper[next], fx), b = mix(lower[0], lower[next], fx);
  std::array<int, 4> mixed;
  for (size_t c = 0; c < 4; ++c) mixed[c] = (a[c] * (256 - fy) + b[c] * fy) >> 8;
  return mixed;
}

std::vector<PlaneRow> make_plane_rows(const Canvas& canvas, double height, const Texture& texture) {
  std::vector<PlaneRow> rows(static_cast<size_t>(canvas.rows()));
  constexpr size_t kMaxHalvings = 5;
  for (int y = 0; y < canvas.rows(); ++y) {
    const double below = std::max(0.05, std::abs(y + 0.5 - canvas.horizon));
    PlaneRow& row = rows[static_cast<size_t>(y)];
    row.depth = height * canvas.focal / below;
    // A pixel covers more of the floor along the view than across it: use the geometric mean.
    const double across = row.depth / canvas.focal, along = row.depth / below;
    row.level = std::min(kMaxHalvings,
                         choose_level(texture, std::sqrt(across * along) * kPlanTexelsPerMeter));
  }
  return rows;
}

struct Planes {
  std::vector<PlaneRow> floor;
  std::vector<PlaneRow> ceiling;
  std::vector<PlaneRow> mirrored_ceiling;  // as the floor reflects it
};

Point on_plane(const Canvas& canvas, const Column& column, double depth) {
  return {canvas.position.x + depth * column.ray.x, canvas.position.y + depth * column.ray.y};
}

// The reflection of a polished floor at a row: the wall upside down, and the ceiling.
std::array<int, 4> reflection(const Canvas& canvas, const Scene& scene, const Planes& planes,
                              const Column& column, int y, double strip_texels_per_m) {
  const double height = (y + 0.5 - canvas.horizon) * column.depth / canvas.focal - canvas.eye;
  if (height < kRoomHeightM)
    return sample_strip(column.strip, (kRoomHeightM - height) * strip_texels_per_m);
  const PlaneRow& row = planes.mirrored_ceiling[static_cast<size_t>(y)];
  return sample_plane(scene.ceiling, scene.plan, row.level, on_plane(canvas, column, row.depth));
}

// Half-transparent texels (at the edge of a frame) transmit half of the light.
int glass_share(const std::array<int, 4>& texel) {  // of 256
  return std::clamp((texel[3] - kGlassDaylight) * 256 / (255 - kGlassDaylight), 0, 256);
}

// Adds the view through the glass of a wall and the reflection in it.
void shine_glass(const Canvas& canvas, const Scene& scene, const Column& column, double middle,
                 const Light& light, std::array<int, 4> texel, std::array<int, 3>& pixel) {
  const int share = glass_share(texel);
  const double up = canvas.horizon - middle;  // pixels
  if (!column.outside.empty() && share > 0) {
    const double ray = std::sqrt(column.ray.x * column.ray.x + column.ray.y * column.ray.y);
    const double tangent = up / canvas.focal / ray;
    const auto far = sample_strip(column.outside,
                                  (1 - tangent) / 2 * static_cast<double>(column.outside.size()));
    const int far_share = static_cast<int>(share * scene.far_view);
    for (size_t c = 0; c < 3; ++c)
      texel[c] = (texel[c] * (256 - far_share) + far[c] * far_share) >> 8;
  }
  shine(texel, light, pixel);
  if (column.mirrored.empty() || share == 0) return;
  const double height = canvas.eye + up * column.mirrored_depth / canvas.focal;
  if (height <= 0 || height >= kRoomHeightM) return;
  std::array<int, 3> mirrored;
  const double texels_per_m = static_cast<double>(column.mirrored.size()) / kRoomHeightM;
  shine(sample_strip(column.mirrored, (kRoomHeightM - height) * texels_per_m), light, mirrored);
  const int bright = static_cast<int>(share * scene.reflections);
  for (size_t c = 0; c < 3; ++c) pixel[c] = std::min(255, pixel[c] + (mirrored[c] * bright >> 8));
}

void paint_column(const Canvas& canvas, const Scene& scene, const Planes& planes,
                  const Column& column, const Light& light, uint8_t* out) {
  const double meters_per_row = column.depth / canvas.focal;
  const double strip_texels_per_m = static_cast<double>(column.strip.size()) / kRoomHeightM;
  const double top = canvas.horizon - (kRoomHeightM - canvas.eye) / meters_per_row;
  const double bottom = canvas.horizon + canvas.eye / meters_per_row;
  std::array<int, 3> pixel;
  for (int y = 0; y < canvas.rows(); ++y, out += 3) {
    const double middle = y + 0.5;
    const auto row = static_cast<size_t>(y);
    if (middle < top) {
      const PlaneRow& plane = planes.ceiling[row];
      shine(sample_plane(scene.ceiling, scene.plan, plane.level,
                         on_plane(canvas, column, plane.depth)),
            light, pixel);
    } else if (middle < bottom) {
      const auto texel =
          sample_strip(column.strip, (middle - top) * meters_per_row * strip_texels_per_m);
      if (column.outside.empty() && column.mirrored.empty()) {
        shine(texel, light, pixel);
      } else {
        shine_glass(canvas, scene, column, middle, light, texel, pixel);
      }
    } else {
      const PlaneRow& plane = planes.floor[row];
      shine(
          sample_plane(scene.floor, scene.plan, plane.level, on_plane(canvas, column, plane.depth)),
          light, pixel);
      std::array<int, 3> mirrored;
      shine(reflection(canvas, scene, planes, column, y, strip_texels_per_m), light, mirrored);
      const int share = static_cast<int>(24 + 70 * std::min(1.0, plane.depth / 9));  // of 256
      for (size_t c = 0; c < 3; ++c)
        pixel[c] = (pixel[c] * (256 - share) + mirrored[c] * share) >> 8;
    }
    for (size_t c = 0; c < 3; ++c) out[c] = static_cast<uint8_t>(pixel[c]);
  }
}

// A person is a flat image that faces the camera, hidden by nearer walls.
void paint_figure(Canvas& canvas, const std::vector<Column>& columns, const Texture& texture,
                  Point position, const Light& light) {
  const double dx = position.x - canvas.position.x, dy = position.y - canvas.position.y;
  const double depth = dx * canvas.forward.x + dy * canvas.forward.y;
  if (depth < kNearestFigureM) return;
  const double scale = canvas.focal / depth;
  const double center =
      canvas.columns() / 2.0 + (dx * canvas.right.x + dy * canvas.right.y) * scale;
  const double left = center - kFigureWidthM / 2 * scale;
  const double top = canvas.horizon - (kFigureHeightM - canvas.eye) * scale;
  const int first = std::clamp(static_cast<int>(std::ceil(left)), 0, canvas.columns());
  const int last = std::clamp(static_cast<int>(left + kFigureWidthM * scale), 0, canvas.columns());
  const int top_row = std::clamp(static_cast<int>(std::ceil(top)), 0, canvas.rows());
  const int bottom_row =
      std::clamp(static_cast<int>(top + kFigureHeightM * scale), 0, canvas.rows());
  const size_t level = choose_level(texture, kTexelsPerMeter / scale);
  std::vector<Texel> strip;
  for (int x = first; x < last; ++x) {
    if (columns[static_cast<size_t>(x)].depth < depth) continue;
    filter_strip(texture, level, (x + 0.5 - left) / scale * kTexelsPerMeter,
                 kTexelsPerMeter / scale, strip);
    const double texels_per_row = static_cast<double>(strip.size()) / kFigureHeightM / scale;
    for (int y = top_row; y < bottom_row; ++y) {
      auto texel = sample_strip(strip, (y + 0.5 - top) * texels_per_row);
      const int cover = texel[3];
      if (cover == 0) continue;
      texel[3] = 0;
      std::array<int, 3> pixel;
      shine(texel, light, pixel);
      auto& below = canvas.turned.at<cv::Vec3b>(x, y);
      // Colors were averaged with the surrounding empty (black) texels, so they are already
      // weighted.
      for (int c = 0; c < 3; ++c)
        below[c] = cv::saturate_cast<uint8_t>(pixel[static_cast<size_t>(c)] +
                                              below[c] * (255 - cover) / 255);
    }
  }
}

void paint_figures(Canvas& canvas, const std::vector<Column>& columns, const View& view,
                   const Light& light) {
  std::vector<std::pair<double, const Figure*>> order;
  for (const Figure& figure : view.figures)
    order.emplace_back((figure.position.x - canvas.position.x) * canvas.forward.x +
                           (figure.position.y - canvas.position.y) * canvas.forward.y,
                       &figure);
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [depth, figure] : order)
    paint_figure(canvas, columns, view.cast[figure->looks].postures[figure->posture],
                 figure->position, light);
}

double metered(const Camera& camera, const View& view, const Canvas& canvas,
               const std::vector<Column>& columns) {
  std::vector<const Column*> some;
  if (view.metered.empty()) {
    for (size_t i = 0; i < columns.size(); i += kMeteredColumns) some.push_back(&columns[i]);
    return metered_brightness(canvas, some, view.conditions);
  }
  double sum = 0;
  for (const CameraPose& pose : view.metered) {
    const Canvas earlier = make_canvas(camera, pose);
    const std::vector<Column> seen = cast_columns(earlier, view.scene, kMeteredColumns);
    some.clear();
    for (const Column& column : seen) some.push_back(&column);
    sum += metered_brightness(earlier, some, view.conditions);
  }
  return sum / static_cast<double>(view.metered.size());
}

void blur_by_motion(const Camera& camera, const View& view, cv::Mat& picture) {
  const double shutter = view.conditions.shutter_s > 0 ? view.conditions.shutter_s : kShutterS;
  const double nod = view.conditions.shutter_s > 0 ? view.pose.nod_deg_s : 0;
  blur_by_turning(picture, view.pose.turn_deg_s * kRadians * camera.focal_px * shutter,
                  nod * kRadians * camera.focal_px * shutter);
}

}  // namespace

cv::Mat render(const Camera& camera, const View& view, RandomEngine noise_engine) {
  const Scene& scene = view.scene;
  Canvas canvas = make_canvas(camera, view.pose);
  const std::vector<Column> columns = cast_columns(canvas, scene);
  const Light light =
      make_light(metered(camera, view, canvas, columns), view.conditions, view.pose.light_drift);
  const Planes planes = {make_plane_rows(canvas, canvas.eye, scene.floor),
                         make_plane_rows(canvas, kRoomHeightM - canvas.eye, scene.ceiling),
                         make_plane_rows(canvas, kRoomHeightM + canvas.eye, scene.ceiling)};
  for (int x = 0; x < canvas.columns(); ++x)
    paint_column(canvas, scene, planes, columns[static_cast<size_t>(x)], light,
                 canvas.turned.ptr<uint8_t>(x));
  paint_figures(canvas, columns, view, light);
  cv::Mat picture = upright(canvas, camera, view.pose.roll_deg);
  blur_by_motion(camera, view, picture);
  add_noise(picture, view.conditions.noise, noise_engine);
  return picture;
}

}  // namespace vpr
