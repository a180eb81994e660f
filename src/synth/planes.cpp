#include "synth/planes.h"

#include <cmath>

#include <opencv2/imgproc.hpp>

namespace vpr {
namespace {

constexpr int kTile = static_cast<int>(0.6 * kPlanTexelsPerMetre);

cv::Mat plan_picture(const FloorPlan& plan) {
  const int cell = static_cast<int>(kPlanCellM * kPlanTexelsPerMetre);
  return cv::Mat(plan.rows * cell, plan.columns * cell, CV_8UC4, cv::Scalar(0));
}

cv::Rect room_on_plan(const Room& room, const FloorPlan& plan) {
  const auto texels = [](double metres) {
    return static_cast<int>(std::lround(metres * kPlanTexelsPerMetre));
  };
  return {texels(room.x - plan.origin.x), texels(room.y - plan.origin.y), texels(room.width),
          texels(room.depth)};
}

// Calls with every room whose finish is its own: corridors first, halls over them.
template <class Painter>
void for_rooms(const Setting& setting, cv::Mat& picture, Painter&& paint) {
  if (setting.world.variety.finishes == 0) return;
  for (const RoomKind kind : {RoomKind::corridor, RoomKind::hall})
    for (size_t i = 0; i < setting.planned.rooms.size(); ++i) {
      const Room& room = setting.planned.rooms[i];
      if (room.kind == kind) paint(setting.rooms[i], picture, room_on_plan(room, setting.plan));
    }
}

}  // namespace

Texture paint_floor(const Setting& setting, const Baked& light) {
  RandomEngine engine = named_engine(setting.world.seed, "ground/" + setting.names.plan);
  cv::Mat picture = plan_picture(setting.plan);
  const double tone = between(engine, 95, 150);
  const double red = tone * between(engine, 1, 1.12);
  const cv::Scalar base = colour(tone * between(engine, 0.8, 1), tone, red);
  const cv::Rect whole(0, 0, picture.cols, picture.rows);
  lay_tiles(picture, whole, kTile, engine, base, 0.06, base * 0.72);
  for_rooms(setting, picture, [&](const Finish& finish, cv::Mat& all, const cv::Rect& part) {
    const cv::Scalar own = base * finish.flooring;
    const int tile = static_cast<int>(finish.flooring_tile_m * kPlanTexelsPerMetre);
    lay_tiles(all, part, tile, engine, own, 0.06, own * 0.72);
    const int border = 2 * static_cast<int>(0.35 * kPlanTexelsPerMetre);
    if (finish.has_runner) cv::rectangle(all, part, own * 0.45, border);
  });
  RandomEngine detail = named_engine(setting.world.seed, "dirt/" + setting.names.own);
  roughen(picture, detail, 9, 9);
  shade(picture, light, 0.95);
  return make_texture(picture);
}

namespace {

void hang_ceilings(const Setting& setting, cv::Mat& picture, RandomEngine& engine) {
  const cv::Scalar base = colour(196, 204, 206);
  lay_tiles(picture, cv::Rect(0, 0, picture.cols, picture.rows), kTile, engine, base, 0.02,
            colour(130, 136, 138));
  for_rooms(setting, picture, [&](const Finish& finish, cv::Mat& all, const cv::Rect& part) {
    const cv::Scalar own = base * finish.ceiling;
    lay_tiles(all, part, kTile, engine, own, 0.02, own * 0.66);
    const int step = kTile / 3;
    if (!finish.has_slats) return;
    for (int y = part.y; y < part.y + part.height; y += step)
      cv::rectangle(all, cv::Rect(part.x, y, part.width, step / 2), own * 0.5, cv::FILLED);
  });
}

}  // namespace

Texture paint_ceiling(const Setting& setting, const Baked& light) {
  const FloorPlan& plan = setting.plan;
  RandomEngine engine = named_engine(setting.world.seed, "ceiling/" + setting.names.plan);
  cv::Mat picture = plan_picture(plan);
  hang_ceilings(setting, picture, engine);
  RandomEngine detail = named_engine(setting.world.seed, "ceiling-detail/" + setting.names.own);
  roughen(picture, detail, 6, 4);
  for (int i = 0; i < plan.rows * plan.columns / 20; ++i)  // detectors and nozzles
    cv::circle(picture,
               {static_cast<int>(uniform_below(detail, static_cast<uint64_t>(picture.cols))),
                static_cast<int>(uniform_below(detail, static_cast<uint64_t>(picture.rows)))},
               4, colour(90, 92, 95), cv::FILLED);
  shade(picture, light, 0.72);
  for (const Lamp& lamp : plan.lamps) {
    if (uniform_unit(detail) < 0.06) continue;  // a broken one
    const auto x = static_cast<int>((lamp.at.x - plan.origin.x - 0.6) * kPlanTexelsPerMetre);
    const auto y = static_cast<int>((lamp.at.y - plan.origin.y - 0.3) * kPlanTexelsPerMetre);
    cv::rectangle(picture, cv::Rect(x, y, 2 * kTile, kTile), colour(255, 255, 255), cv::FILLED);
    for (int bar = kTile / 2; bar < 2 * kTile; bar += kTile / 2)
      cv::line(picture, {x + bar, y}, {x + bar, y + kTile}, colour(215, 220, 222));
  }
  return make_texture(picture);
}

}  // namespace vpr
