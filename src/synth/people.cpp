#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

#include "synth/walking.h"

namespace vpr {
namespace {

constexpr size_t kPeople = 14;

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

cv::Mat draw_person(const Wardrobe& clothes, double stride_cm) {
  cv::Mat picture(wall_texels(kFigureHeightM), wall_texels(kFigureWidthM), CV_8UC4, cv::Scalar(0));
  // In centimeters: x from the middle, y from the ground.
  const auto texels = [](double cm) { return wall_texels(cm / 100); };
  const auto at = [&](double x, double y) {
    return cv::Point(picture.cols / 2 + texels(x), picture.rows - 1 - texels(y * clothes.height));
  };
  const auto limb = [&](cv::Point from, cv::Point to, double thick, const cv::Scalar& c) {
    cv::line(picture, from, to, c, std::max(1, texels(thick)), cv::LINE_8);
  };
  const auto oval = [&](double x, double y, double rx, double ry, const cv::Scalar& c) {
    cv::ellipse(picture, at(x, y), {texels(rx), texels(ry)}, 0, 0, 360, c, cv::FILLED);
  };
  const auto block = [&](cv::Point top_left, cv::Point bottom_right, const cv::Scalar& c) {
    cv::rectangle(picture, top_left, bottom_right, c, cv::FILLED);
  };
  for (const double leg : {-1.0, 1.0}) {
    const double foot = leg * (9 + stride_cm * 0.3), lift = leg * stride_cm > 0 ? stride_cm / 4 : 0;
    limb(at(leg * 9, 86), at(foot, 6 + std::abs(lift)), 15, clothes.trousers);
    oval(foot, 4 + std::abs(lift), 8, 4, opaque(25, 25, 28));
  }
  block(at(-20, 145), at(20, 82), clothes.shirt);
  oval(0, 143, 21, 9, clothes.shirt);
  if (clothes.striped)
    for (double y = 90; y < 140; y += 12) block(at(-20, y + 5), at(20, y), clothes.stripe);
  if (clothes.backpack) block(at(-15, 138), at(15, 95), clothes.stripe * 0.6);
  for (const double arm : {-1.0, 1.0}) {
    limb(at(arm * 23, 140), at(arm * (27 + stride_cm * 0.15), 88), 9, clothes.shirt * 0.85);
    oval(arm * (27 + stride_cm * 0.15), 82, 5, 6, clothes.skin);
  }
  block(at(-5, 155), at(5, 145), clothes.skin);
  oval(0, 164, 10, 13, clothes.skin);
  oval(0, 169, 11, 10, clothes.hair);
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

// Along the path; across it; or ahead of the camera, at its speed.
enum class Motion { along, crosses, leads };

struct Member {
  double path_m = 0;     // position on the path at time 0; leads: distance ahead of the camera
  double speed_m_s = 0;  // along the path; 0: stands
  double aside_m = 0;    // offset to the left of the path
  size_t person = 0;
  Motion motion = Motion::along;
  double from_s = 0;  // leads: start of visibility
  double to_s = 0;    // leads: its end; crosses: reaches the middle of the path at from_s
};

std::vector<Member> draw_members(const World& world, const Walk& walk, const FloorPlan& plan,
                                 const Path& path, const std::vector<CameraPose>& poses,
                                 size_t people_count) {
  std::vector<Member> members;
  RandomEngine engine = named_engine(world.seed, "people/" + walk.name);
  // They pass the camera at some time of the walk: most come toward it, some overtake it.
  for (size_t group = 0; group < walk.passers_by; ++group) {
    const CameraPose& meeting = poses[uniform_below(engine, poses.size())];
    const double pace = between(engine, 0.9, 1.5);
    const double speed = pace * (uniform_unit(engine) < 0.8 ? -1 : 1.4);
    const double distance = between(engine, 0.35, 0.7);
    const double aside = distance * (uniform_unit(engine) < 0.5 ? -1 : 1);
    const size_t size = 1 + uniform_below(engine, 3);
    for (size_t i = 0; i < size; ++i) {
      const double ahead = meeting.path_m + between(engine, -0.4, 0.4);
      members.push_back({ahead - speed * meeting.time_s, speed,
                         aside + (static_cast<double>(i) - 0.5) * between(engine, 0.3, 0.5),
                         uniform_below(engine, people_count)});
    }
  }
  for (size_t group = 0; group < walk.standing; ++group) {
    const double path_m = path.length_m() * uniform_unit(engine);
    const double side = uniform_unit(engine) < 0.5 ? -1 : 1;
    const double normal = (path.heading_at(path_m) + 90 * side) * std::numbers::pi / 180;
    const auto wall = cast_ray(plan, path.at(path_m), {std::cos(normal), std::sin(normal)});
    const double room = wall ? std::min(wall->distance, 2.5) : 1;
    const size_t size = 1 + uniform_below(engine, 4);
    for (size_t i = 0; i < size; ++i)
      members.push_back({path_m + static_cast<double>(i) * between(engine, 0.35, 0.6), 0,
                         side * std::max(0.4, room - between(engine, 0.3, 0.6)),
                         uniform_below(engine, people_count)});
  }
  // They cross the path a few meters ahead of the camera.
  for (size_t group = 0; group < walk.crossing; ++group) {
    const CameraPose& meeting = poses[uniform_below(engine, poses.size())];
    const double path_m = meeting.path_m + between(engine, 1.2, 4);
    const double pace = between(engine, 0.7, 1.3);
    const double speed = pace * (uniform_unit(engine) < 0.5 ? -1 : 1);
    const size_t size = 1 + uniform_below(engine, 2);
    for (size_t i = 0; i < size; ++i)
      members.push_back({path_m + static_cast<double>(i) * between(engine, -0.3, 0.3), speed, 0,
                         uniform_below(engine, people_count), Motion::crosses,
                         meeting.time_s + static_cast<double>(i) * between(engine, 0.3, 0.8), 0});
  }
  // They walk a few meters ahead of the camera for a while.
  for (size_t group = 0; group < walk.ahead; ++group) {
    const double from = poses[uniform_below(engine, poses.size())].time_s;
    const double to = from + between(engine, 5, 20), gap = between(engine, 1.3, 4);
    const double aside = between(engine, -0.5, 0.3);
    const size_t size = 1 + uniform_below(engine, 3);
    for (size_t i = 0; i < size; ++i)
      members.push_back({gap + between(engine, 0, 0.3), between(engine, 0.02, 0.15),
                         aside + static_cast<double>(i) * between(engine, 0.45, 0.6),
                         uniform_below(engine, people_count), Motion::leads, from, to});
  }
  return members;
}

// The position of a member at this pose; beyond the path if the member is not visible.
Member moved(const Member& member, const CameraPose& pose) {
  const double since_s = pose.time_s - member.from_s;
  Member now = member;
  if (member.motion == Motion::along) now.path_m += member.speed_m_s * pose.time_s;
  if (member.motion == Motion::crosses) now.aside_m = member.speed_m_s * since_s;
  if (member.motion == Motion::leads) {
    now.path_m += pose.path_m + member.speed_m_s * since_s;
    if (pose.time_s < member.from_s || pose.time_s > member.to_s) now.path_m = -1;
  }
  return now;
}

}  // namespace

std::vector<PersonImages> make_people(uint64_t seed) {
  RandomEngine engine = named_engine(seed, "cast");
  std::vector<PersonImages> people(kPeople);
  for (PersonImages& person : people) {
    const Wardrobe clothes(engine);
    const std::array<double, 3> strides = {0, 22, -22};
    for (size_t i = 0; i < strides.size(); ++i)
      person.postures[i] = make_wall_texture(draw_person(clothes, strides[i]));
  }
  return people;
}

std::vector<std::vector<Figure>> people_on_walk(const World& world, const Walk& walk,
                                                const FloorPlan& plan,
                                                const std::vector<CameraPose>& poses,
                                                size_t people_count) {
  const Path path(walk.path);
  const auto members = draw_members(world, walk, plan, path, poses, people_count);
  std::vector<std::vector<Figure>> figures(poses.size());
  for (size_t i = 0; i < poses.size(); ++i)
    for (const Member& member_before : members) {
      const Member member = moved(member_before, poses[i]);
      const double path_m = member.path_m;
      if (path_m < 0 || path_m > path.length_m()) continue;
      const Point place = path.at(path_m, member.aside_m);
      if (!plan.is_open(place)) continue;
      const bool walks = member.speed_m_s != 0;
      const double walked = member.motion == Motion::crosses ? std::abs(member.aside_m) : path_m;
      const bool second_half = std::fmod(walked / 1.3, 1.0) > 0.5;
      figures[i].push_back(
          {place, member.person, walks ? 1 + static_cast<size_t>(second_half) : size_t{0}});
    }
  return figures;
}

}  // namespace vpr
