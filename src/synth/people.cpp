#include "synth/people.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "synth/surfaces.h"

namespace vpr {
namespace {

constexpr size_t kCast = 14;

cv::Scalar opaque(double blue, double green, double red) { return {blue, green, red, 255}; }

cv::Scalar any_cloth(RandomEngine& engine) {
  const double tone = between(engine, 30, 190);
  const double red = tone * between(engine, 0.5, 1.3), green = tone * between(engine, 0.5, 1.1);
  return opaque(tone * between(engine, 0.5, 1.3), green, red);
}

struct Wardrobe {
  cv::Scalar skin, hair, shirt, trousers, stripe;
  bool striped = false;
  bool backpack = false;
  double height = 1;

  explicit Wardrobe(RandomEngine& engine) {
    const double tan = between(engine, 0.55, 1);
    skin = opaque(140 * tan, 170 * tan, 215 * tan);
    const double dark = between(engine, 15, 90);
    hair = opaque(dark * 0.6, dark * 0.8, dark);
    shirt = any_cloth(engine);
    const double red = between(engine, 20, 70), green = between(engine, 25, 70);
    trousers = opaque(between(engine, 30, 110), green, red);
    stripe = any_cloth(engine);
    striped = uniform_unit(engine) < 0.35;
    backpack = uniform_unit(engine) < 0.3;
    height = between(engine, 0.9, 1);
  }
};

// In centimeters: x from the middle, y from the ground.
class Figurine {
 public:
  explicit Figurine(cv::Mat& picture, double height) : picture_(picture), height_(height) {}

  void limb(double x0, double y0, double x1, double y1, double thick, const cv::Scalar& c) {
    cv::line(picture_, at(x0, y0), at(x1, y1), c, std::max(1, pixels(thick)), cv::LINE_8);
  }
  void oval(double x, double y, double rx, double ry, const cv::Scalar& c) {
    cv::ellipse(picture_, at(x, y), {pixels(rx), pixels(ry)}, 0, 0, 360, c, cv::FILLED);
  }
  void block(double left, double bottom, double right, double top, const cv::Scalar& c) {
    cv::rectangle(picture_, at(left, top), at(right, bottom), c, cv::FILLED);
  }

 private:
  static int pixels(double cm) { return static_cast<int>(std::lround(cm / 100 * kTexelsPerMeter)); }
  cv::Point at(double x, double y) const {
    return {picture_.cols / 2 + pixels(x), picture_.rows - 1 - pixels(y * height_)};
  }
  cv::Mat& picture_;
  double height_;
};

cv::Mat draw_person(const Wardrobe& clothes, double stride_cm) {
  cv::Mat picture(static_cast<int>(kFigureHeightM * kTexelsPerMeter),
                  static_cast<int>(kFigureWidthM * kTexelsPerMeter), CV_8UC4, cv::Scalar(0));
  Figurine figure(picture, clothes.height);
  for (const double leg : {-1.0, 1.0}) {
    const double foot = leg * (9 + stride_cm * 0.3), lift = leg * stride_cm > 0 ? stride_cm / 4 : 0;
    figure.limb(leg * 9, 86, foot, 6 + std::abs(lift), 15, clothes.trousers);
    figure.oval(foot, 4 + std::abs(lift), 8, 4, opaque(25, 25, 28));
  }
  figure.block(-20, 82, 20, 145, clothes.shirt);
  figure.oval(0, 143, 21, 9, clothes.shirt);
  if (clothes.striped)
    for (double y = 90; y < 140; y += 12) figure.block(-20, y, 20, y + 5, clothes.stripe);
  if (clothes.backpack) figure.block(-15, 95, 15, 138, clothes.stripe * 0.6);
  for (const double arm : {-1.0, 1.0}) {
    figure.limb(arm * 23, 140, arm * (27 + stride_cm * 0.15), 88, 9, clothes.shirt * 0.85);
    figure.oval(arm * (27 + stride_cm * 0.15), 82, 5, 6, clothes.skin);
  }
  figure.block(-5, 145, 5, 155, clothes.skin);
  figure.oval(0, 164, 10, 13, clothes.skin);
  figure.oval(0, 169, 11, 10, clothes.hair);
  // Drawn pixels cover completely; the mipmap levels soften the edges.
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      auto& texel = picture.at<cv::Vec4b>(y, x);
      const bool covers = texel[0] + texel[1] + texel[2] > 0;
      const double round = 1 - 0.35 * std::abs(x - picture.cols / 2.0) / (picture.cols / 2.0);
      for (int c = 0; c < 3; ++c) texel[c] = cv::saturate_cast<uint8_t>(texel[c] * round);
      texel[3] = covers ? 255 : 0;
    }
  return picture;
}

}  // namespace

std::vector<Looks> make_cast(uint64_t seed) {
  RandomEngine engine = named_engine(seed, "cast");
  std::vector<Looks> cast(kCast);
  for (Looks& looks : cast) {
    const Wardrobe clothes(engine);
    const std::array<double, 3> strides = {0, 22, -22};
    for (size_t i = 0; i < strides.size(); ++i)
      looks.postures[i] = make_wall_texture(draw_person(clothes, strides[i]));
  }
  return cast;
}

Crowd::Crowd(const World& world, const Walk& walk, const FloorPlan& plan,
             const std::vector<CameraPose>& poses, size_t cast_size)
    : plan_(plan), path_(walk.path), cast_size_(cast_size), fps_(world.fps) {
  for (const CameraPose& pose : poses) camera_ways_.push_back(pose.way_m);
  RandomEngine engine = named_engine(world.seed, "people/" + walk.name);
  add_passers_by(engine, poses, walk.passers_by);
  add_standing(engine, walk.standing);
  add_crossing(engine, poses, walk.crossing);
  add_ahead(engine, poses, walk.ahead);
}

// Everyone passes the camera at some time of the walk: most come toward it, some overtake it.
void Crowd::add_passers_by(RandomEngine& engine, const std::vector<CameraPose>& poses,
                           size_t groups) {
  for (size_t group = 0; group < groups; ++group) {
    const CameraPose& meeting = poses[uniform_below(engine, poses.size())];
    const double pace = between(engine, 0.9, 1.5);
    const double speed = pace * (uniform_unit(engine) < 0.8 ? -1 : 1.4);
    const double distance = between(engine, 0.35, 0.7);
    const double aside = distance * (uniform_unit(engine) < 0.5 ? -1 : 1);
    const size_t size = 1 + uniform_below(engine, 3);
    for (size_t i = 0; i < size; ++i) {
      const double ahead = meeting.way_m + between(engine, -0.4, 0.4);
      members_.push_back({ahead - speed * meeting.time_s, speed,
                          aside + (static_cast<double>(i) - 0.5) * between(engine, 0.3, 0.5),
                          uniform_below(engine, cast_size_)});
    }
  }
}

void Crowd::add_standing(RandomEngine& engine, size_t groups) {
  for (size_t group = 0; group < groups; ++group) {
    const double way = path_.length_m() * uniform_unit(engine);
    const double side = uniform_unit(engine) < 0.5 ? -1 : 1;
    const double normal = (path_.heading_at(way) + 90 * side) * std::numbers::pi / 180;
    const auto wall = cast_ray(plan_, path_.at(way), {std::cos(normal), std::sin(normal)});
    const double room = wall ? std::min(wall->distance, 2.5) : 1;
    const size_t size = 1 + uniform_below(engine, 4);
    for (size_t i = 0; i < size; ++i)
      members_.push_back({way + static_cast<double>(i) * between(engine, 0.35, 0.6), 0,
                          side * std::max(0.4, room - between(engine, 0.3, 0.6)),
                          uniform_below(engine, cast_size_)});
  }
}

// They cross the path a few meters ahead of the camera.
void Crowd::add_crossing(RandomEngine& engine, const std::vector<CameraPose>& poses,
                         size_t groups) {
  for (size_t group = 0; group < groups; ++group) {
    const CameraPose& meeting = poses[uniform_below(engine, poses.size())];
    const double way = meeting.way_m + between(engine, 1.2, 4);
    const double pace = between(engine, 0.7, 1.3);
    const double speed = pace * (uniform_unit(engine) < 0.5 ? -1 : 1);
    const size_t size = 1 + uniform_below(engine, 2);
    for (size_t i = 0; i < size; ++i)
      members_.push_back({way + static_cast<double>(i) * between(engine, -0.3, 0.3), speed, 0,
                          uniform_below(engine, cast_size_), Motion::crosses,
                          meeting.time_s + static_cast<double>(i) * between(engine, 0.3, 0.8), 0});
  }
}

// They walk a few meters ahead of the camera for a while.
void Crowd::add_ahead(RandomEngine& engine, const std::vector<CameraPose>& poses, size_t groups) {
  for (size_t group = 0; group < groups; ++group) {
    const double from = poses[uniform_below(engine, poses.size())].time_s;
    const double to = from + between(engine, 5, 20), gap = between(engine, 1.3, 4);
    const double aside = between(engine, -0.5, 0.3);
    const size_t size = 1 + uniform_below(engine, 3);
    for (size_t i = 0; i < size; ++i)
      members_.push_back({gap + between(engine, 0, 0.3), between(engine, 0.02, 0.15),
                          aside + static_cast<double>(i) * between(engine, 0.45, 0.6),
                          uniform_below(engine, cast_size_), Motion::leads, from, to});
  }
}

double Crowd::camera_way(double time_s) const {
  const auto frame = static_cast<size_t>(std::max(0.0, std::round(time_s * fps_)));
  return camera_ways_[std::min(frame, camera_ways_.size() - 1)];
}

// The position of a member at this time; beyond the path if the member is not visible.
Crowd::Member Crowd::moved(const Member& member, double time_s) const {
  constexpr double kNowhere = -1;
  Member now = member;
  switch (member.motion) {
    case Motion::along:
      now.way_m += member.speed_m_s * time_s;
      break;
    case Motion::crosses:
      now.aside_m = member.speed_m_s * (time_s - member.from_s);
      break;
    case Motion::leads:
      now.way_m += camera_way(time_s) + member.speed_m_s * (time_s - member.from_s);
      if (time_s < member.from_s || time_s > member.to_s) now.way_m = kNowhere;
      break;
  }
  return now;
}

std::vector<Figure> Crowd::at(double time_s) const {
  std::vector<Figure> figures;
  for (const Member& member_before : members_) {
    const Member member = moved(member_before, time_s);
    const double way = member.way_m;
    if (way < 0 || way > path_.length_m()) continue;
    const double normal = (path_.heading_at(way) + 90) * std::numbers::pi / 180;
    const Point on_path = path_.at(way);
    const Point place{on_path.x + member.aside_m * std::cos(normal),
                      on_path.y + member.aside_m * std::sin(normal)};
    if (!plan_.is_open(place)) continue;
    const bool walks = member.speed_m_s != 0;
    const double walked = member.motion == Motion::crosses ? std::abs(member.aside_m) : way;
    const bool second_half = std::fmod(walked / 1.3, 1.0) > 0.5;
    figures.push_back(
        {place, member.looks, walks ? 1 + static_cast<size_t>(second_half) : size_t{0}});
  }
  return figures;
}

}  // namespace vpr
