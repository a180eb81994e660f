#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "synth/scene.h"

namespace vpr {
namespace {

constexpr double kNearestFigureM = 0.5;
constexpr int kMeteredColumns = 16;     // one of this many columns of an image is metered
constexpr double kShutterS = 1.0 / 50;  // the default
constexpr double kRadians = std::numbers::pi / 180;  // per degree

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
};

/// The wall that one column of pixels shows.
struct Column {
  Point ray;                    ///< length 1 along the camera's axis, so that distances are depths
  double depth = 0;             ///< meters, along the camera's axis
  std::vector<Texel> strip;     ///< of the wall, from top to bottom
  std::vector<Texel> outside;   ///< of the panorama outside the glass, from top to bottom; or empty
  std::vector<Texel> mirrored;  ///< of the wall reflected in the glass; or empty
  double mirrored_depth = 0;    ///< meters, along the camera's axis
};

/// Factors in units of 1/256 for texels lit by lamps and by daylight: blue, green, red.
struct Light {
  std::array<int, 3> lamps{};
  std::array<int, 3> day{};
};

// Converts a texel (blue, green, red, daylight share of 255) to the gray values of a pixel.
void shine(const std::array<int, 4>& texel, const Light& light, std::array<int, 3>& out) {
  for (size_t c = 0; c < 3; ++c) {
    const int factor = light.lamps[c] + ((light.day[c] - light.lamps[c]) * texel[3] >> 8);
    out[c] = std::min(255, texel[c] * factor >> 8);
  }
}

constexpr int kMargin = 24;         // rendered around the image, for the roll of the camera
constexpr double kNearestM = 0.25;  // minimum distance to a wall

// Meters of wall per pixel in horizontal direction.
double meters_per_pixel(const Canvas& canvas, const Wall& wall, const Column& column) {
  const Point way = wall.direction();
  const Point normal{-way.y, way.x};
  const double turn = normal.dot(canvas.right) / normal.dot(column.ray);
  const Point step = canvas.right - turn * column.ray;
  return std::abs(step.dot(way)) * column.depth / canvas.focal;
}

// The view through glass, and the reflection in it: the next wall that the reflected ray hits, at
// the depth of both paths together.
void cast_through_glass(const Canvas& canvas, const Scene& scene, const WallHit& hit,
                        Column& column) {
  if (std::ranges::none_of(column.strip,
                           [](const Texel& texel) { return texel[3] >= kGlassDaylight; }))
    return;
  if (scene.far_view > 0)
    panorama_strip(scene.outside, column.ray, 1 / canvas.focal, column.outside);
  if (scene.reflections == 0) return;
  // share of the way to the glass, so that the reflected ray starts inside the room
  constexpr double kBefore = 0.999;
  const Side side = scene.plan.walls[static_cast<size_t>(hit.wall)].side;
  const bool is_sideways = side == Side::right || side == Side::left;
  const Point back{is_sideways ? -column.ray.x : column.ray.x,
                   is_sideways ? column.ray.y : -column.ray.y};
  const Point from = canvas.position + column.ray * hit.distance * kBefore;
  const auto next = cast_ray(scene.plan, from, back);
  if (!next) return;
  column.mirrored_depth = hit.distance + next->distance;
  const Texture& texture = scene.walls[static_cast<size_t>(next->wall)];
  const double texels = column.mirrored_depth / canvas.focal * kTexelsPerMeter;
  filter_strip(texture, choose_level(texture, texels), next->along_m * kTexelsPerMeter, texels,
               column.mirrored);
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

// An empty canvas for a camera pose, with a margin on every side for the camera's roll. Pitch is
// limited to 40 degrees.
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

// Every `every`th column of a canvas, from left to right. The camera must be in an open cell.
std::vector<Column> cast_columns(const Canvas& canvas, const Scene& scene, int every = 1) {
  std::vector<Column> columns(static_cast<size_t>((canvas.columns() + every - 1) / every));
  for (int i = 0; i < canvas.columns(); i += every) {
    Column& column = columns[static_cast<size_t>(i / every)];
    const double t = (i + 0.5 - canvas.columns() / 2.0) / canvas.focal;
    column.ray = canvas.forward + t * canvas.right;
    const auto hit = cast_ray(scene.plan, canvas.position, column.ray);
    column.depth = std::max(hit->distance, kNearestM);
    const double texels = column.depth / canvas.focal * kTexelsPerMeter;
    const auto wall = static_cast<size_t>(hit->wall);
    filter_strip(
        scene.walls[wall], choose_level(scene.walls[wall], texels), hit->along_m * kTexelsPerMeter,
        meters_per_pixel(canvas, scene.plan.walls[wall], column) * kTexelsPerMeter, column.strip);
    cast_through_glass(canvas, scene, *hit, column);
  }
  return columns;
}

// The canvas as an upright image, rotated by the camera's roll (degrees, clockwise) and cropped.
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

// The mean brightness of a canvas in gray values before exposure, estimated from every `every`th of
// these columns.
double metered_brightness(const Canvas& canvas, const std::vector<Column>& columns, size_t every,
                          const Conditions& conditions) {
  constexpr double kFloorAndCeiling = 110;
  double sum = 0;
  size_t count = 0;
  for (size_t i = 0; i < columns.size(); i += every, ++count) {
    const Column& column = columns[i];
    double wall = 0;
    for (const Texel& texel : column.strip) wall += std::min(255.0, brightness(texel, conditions));
    wall /= static_cast<double>(column.strip.size());
    const double share = std::min(1.0, kRoomHeightM * canvas.focal / column.depth / canvas.rows());
    sum += share * wall + (1 - share) * kFloorAndCeiling * conditions.lamps;
  }
  return sum / static_cast<double>(count);
}

// The light under automatic exposure for a metered `brightness`; the target is a fixed mean gray
// value. `drift` is a factor on the exposure.
Light make_light(double brightness, const Conditions& conditions, double drift) {
  const double gain =
      std::clamp(std::pow(kMeanBrightness / std::max(brightness, 1.0), 0.8), 0.3, 3.0) * drift *
      256;
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

// Adds normal noise with this standard deviation in gray values to every channel of every pixel.
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

/// One image row of floor or ceiling: all its pixels have the same depth.
struct PlaneRow {
  double depth = 0;
  size_t level = 0;
};

// Replaces the first `Count` channels of a by mixtures with b, of which b has `share_b` / 256.
template <size_t Count, class A, class B>
void mix_in(A& a, const B& b, int share_b) {
  for (size_t c = 0; c < Count; ++c) a[c] = (a[c] * (256 - share_b) + b[c] * share_b) >> 8;
}

std::array<int, 4> mix(const Texel& a, const Texel& b, int share_b) {
  std::array<int, 4> mixed = {a[0], a[1], a[2], a[3]};
  mix_in<4>(mixed, std::array<int, 4>{b[0], b[1], b[2], b[3]}, share_b);
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
  auto mixed = mix(upper[0], upper[next], fx);
  mix_in<4>(mixed, mix(lower[0], lower[next], fx), fy);
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

// The reflection of a polished floor at a row: the wall upside down, and the ceiling.
std::array<int, 4> reflection(const Canvas& canvas, const Scene& scene, const Planes& planes,
                              const Column& column, int y, double strip_texels_per_m) {
  const double height = (y + 0.5 - canvas.horizon) * column.depth / canvas.focal - canvas.eye;
  if (height < kRoomHeightM)
    return sample_strip(column.strip, (kRoomHeightM - height) * strip_texels_per_m);
  const PlaneRow& row = planes.mirrored_ceiling[static_cast<size_t>(y)];
  return sample_plane(scene.ceiling, scene.plan, row.level,
                      canvas.position + row.depth * column.ray);
}

// Adds the view through the glass of a wall and the reflection in it.
void shine_glass(const Canvas& canvas, const Scene& scene, const Column& column, double middle,
                 const Light& light, std::array<int, 4> texel, std::array<int, 3>& pixel) {
  // Half-transparent texels (at the edge of a frame) transmit half of the light.
  const int share = std::clamp((texel[3] - kGlassDaylight) * 256 / (255 - kGlassDaylight), 0, 256);
  const double up = canvas.horizon - middle;  // pixels
  if (!column.outside.empty() && share > 0) {
    const double ray = std::sqrt(column.ray.dot(column.ray));
    const double tangent = up / canvas.focal / ray;
    const auto far = sample_strip(column.outside,
                                  (1 - tangent) / 2 * static_cast<double>(column.outside.size()));
    mix_in<3>(texel, far, static_cast<int>(share * scene.far_view));
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
                         canvas.position + plane.depth * column.ray),
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
      shine(sample_plane(scene.floor, scene.plan, plane.level,
                         canvas.position + plane.depth * column.ray),
            light, pixel);
      std::array<int, 3> mirrored;
      shine(reflection(canvas, scene, planes, column, y, strip_texels_per_m), light, mirrored);
      mix_in<3>(pixel, mirrored, static_cast<int>(24 + 70 * std::min(1.0, plane.depth / 9)));
    }
    for (size_t c = 0; c < 3; ++c) out[c] = static_cast<uint8_t>(pixel[c]);
  }
}

// A person is a flat image that faces the camera, hidden by nearer walls.
void paint_figure(Canvas& canvas, const std::vector<Column>& columns, const Texture& texture,
                  Point position, const Light& light) {
  const Point way = position - canvas.position;
  const double depth = way.dot(canvas.forward);
  if (depth < kNearestFigureM) return;
  const double scale = canvas.focal / depth;
  const double center = canvas.columns() / 2.0 + way.dot(canvas.right) * scale;
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
    order.emplace_back((figure.position - canvas.position).dot(canvas.forward), &figure);
  std::ranges::stable_sort(order, [](const auto& a, const auto& b) { return a.first > b.first; });
  for (const auto& [depth, figure] : order)
    paint_figure(canvas, columns, view.people[figure->person].postures[figure->posture],
                 figure->position, light);
}

double metered(const Camera& camera, const View& view, const Canvas& canvas,
               const std::vector<Column>& columns) {
  if (view.metered.empty())
    return metered_brightness(canvas, columns, kMeteredColumns, view.conditions);
  double sum = 0;
  for (const CameraPose& pose : view.metered) {
    const Canvas earlier = make_canvas(camera, pose);
    sum += metered_brightness(earlier, cast_columns(earlier, view.scene, kMeteredColumns), 1,
                              view.conditions);
  }
  return sum / static_cast<double>(view.metered.size());
}

// Motion blur for the movement of the image during the exposure.
void blur_by_motion(const Camera& camera, const View& view, cv::Mat& picture) {
  const double exposure = view.conditions.shutter_s;
  const auto odd = [&](double deg_s, double shutter_s) {  // an odd size shifts nothing
    const double pixels =
        std::min<double>(kMaxBlur, std::abs(deg_s * kRadians * camera.focal_px * shutter_s));
    return std::max(1, 2 * static_cast<int>(std::lround((pixels - 1) / 2)) + 1);
  };
  const cv::Size size(odd(view.pose.turn_deg_s, exposure > 0 ? exposure : kShutterS),
                      odd(view.pose.nod_deg_s, exposure));
  if (size.area() > 1) cv::blur(picture, picture, size);
}

}  // namespace

Camera make_camera(const World& world) {
  const auto width = static_cast<int>(world.image_width);
  return {width, static_cast<int>(world.image_height),
          width / 2.0 / std::tan(kViewDeg / 2 * kRadians)};
}

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
