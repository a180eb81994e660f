// Objects on the walls: doors, boards, posters, lockers, radiators, windows.
#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "synth/surfaces.h"
#include "synth/world.h"

namespace vpr {
namespace {

void paint_sheet(WallBrush& brush, double x, double bottom, double width, double height) {
  RandomEngine& chance_of = brush.detail;
  const double red = between(chance_of, 205, 250), green = between(chance_of, 215, 250);
  brush.fill(x, bottom, width, height, color(between(chance_of, 205, 245), green, red));
  const double picture_height = chance(chance_of, 0.5) ? height * between(chance_of, 0.2, 0.5) : 0;
  if (picture_height > 0)
    brush.fill(x + width * 0.1, bottom + height * 0.92 - picture_height, width * 0.8,
               picture_height, any_color(chance_of, 40, 230));
  brush.write(x + width * 0.1, bottom + height * 0.06, width * 0.8, height * 0.82 - picture_height,
              0.035, any_color(chance_of, 10, 90));
}

void paint_board(WallBrush& brush, double x, double width) {
  const double bottom = between(brush.style, 0.95, 1.1), height = between(brush.style, 0.85, 1.05);
  const std::array<cv::Scalar, 3> cloths = {color(70, 125, 165), color(120, 80, 50),
                                            color(85, 110, 70)};
  brush.fill_framed(x, bottom, width, height, cloths[uniform_below(brush.style, cloths.size())],
                    color(110, 120, 125), 0.035);
  const int columns = std::max(1, static_cast<int>(width / 0.3));
  for (int column = 0; column < columns; ++column)
    for (int row = 0; row < 2; ++row) {
      if (chance(brush.detail, 0.2)) continue;
      const double dx = between(brush.detail, 0.02, 0.07), dy = between(brush.detail, 0.03, 0.1);
      paint_sheet(brush, x + 0.04 + column * 0.3 + dx, bottom + 0.03 + row * height * 0.47 + dy,
                  0.21, 0.3);
    }
}

void paint_poster(WallBrush& brush, double x, double width) {
  const double height = width * 1.35, bottom = between(brush.style, 0.8, 1.1);
  const cv::Scalar ground = any_color(brush.detail, 60, 235);
  brush.fill_framed(x, bottom, width, height, ground, color(40, 40, 45), 0.02);
  const int blots = static_cast<int>(between(brush.detail, 3, 8));
  for (int i = 0; i < blots; ++i) {
    const cv::Rect inside = brush.area(x + 0.1, bottom + 0.12, width - 0.2, height * 0.6);
    const int down = static_cast<int>(between(brush.detail, 0, inside.height));
    const int across = static_cast<int>(between(brush.detail, 0, inside.width));
    const cv::Point center(inside.x + across, inside.y + down);
    const int radius = wall_texels(between(brush.detail, 0.03, 0.12));
    if (chance(brush.detail, 0.5)) {
      cv::circle(brush.picture, center, radius, any_color(brush.detail, 20, 250), cv::FILLED,
                 cv::LINE_AA);
    } else {
      cv::rectangle(brush.picture,
                    cv::Rect(center.x - radius, center.y - radius / 2, 2 * radius, radius),
                    any_color(brush.detail, 20, 250), cv::FILLED);
    }
  }
  const cv::Scalar ink = ground[1] > 140 ? color(20, 20, 30) : color(240, 245, 245);
  brush.write(x + 0.07, bottom + height * 0.8, width - 0.14, height * 0.15, 0.11, ink);
  brush.write(x + 0.07, bottom + 0.05, width - 0.14, height * 0.14, 0.04, ink);
}

constexpr double kDoorWidthM = 0.95, kDoorHeightM = 2.05;

// The view through an open door: a dark or lit room.
void open_door(WallBrush& brush, double x) {
  RandomEngine& day = brush.day;
  const double tone = chance(day, 0.5) ? between(day, 20, 60) : between(day, 150, 235);
  brush.fill(x, 0, kDoorWidthM, kDoorHeightM, color(tone * 0.95, tone, tone));
  brush.fill(x, 0, kDoorWidthM, between(day, 0.3, 0.6), color(tone * 0.5, tone * 0.55, tone * 0.6));
  const double left = between(day, 0.05, 0.4), width = between(day, 0.2, 0.45);
  const cv::Scalar thing = any_color(day, 20, 240);
  const double height = between(day, 0.4, 0.9);
  brush.fill(x + left, between(day, 0.3, 1.1), width, height, thing);
  const cv::Scalar leaf = any_color(day, 70, 150);  // its edge, which points into the room
  brush.fill(chance(day, 0.5) ? x : x + kDoorWidthM - 0.14, 0, 0.14, kDoorHeightM, leaf);
}

// Objects left at the wall: boxes, chairs, bins, trolleys.
void leave_things(WallBrush& brush) {
  const auto things = 1 + uniform_below(brush.day, 2);
  for (uint64_t i = 0; i < things; ++i) {
    const double x = between(brush.day, 0, 1.2), width = between(brush.day, 0.35, 0.8);
    const double height = between(brush.day, 0.4, 1.4), legs = between(brush.day, 0, 0.3);
    const cv::Scalar paint = any_color(brush.day, 30, 220);
    brush.fill_framed(x, legs, width, height - legs, paint, darker(paint, 0.5), 0.03);
    for (const double leg : {0.03, width - 0.07})
      brush.fill(x + leg, 0, 0.04, legs, color(45, 45, 48));
  }
}

void paint_door(WallBrush& brush, double x) {
  const std::array<cv::Scalar, 4> woods = {color(75, 115, 160), color(60, 85, 115),
                                           color(165, 170, 172), color(125, 95, 70)};
  const cv::Scalar& wood = woods[uniform_below(brush.style, woods.size())];
  brush.fill_framed(x - 0.07, 0, kDoorWidthM + 0.14, kDoorHeightM + 0.07, wood, darker(wood, 0.55),
                    0.06);
  brush.fill(x, 0, kDoorWidthM, kDoorHeightM, wood);
  cv::Mat leaf = brush.part(x, 0, kDoorWidthM, kDoorHeightM);
  for (int i = 0; i < 40 && leaf.cols > 0; ++i) {  // grain
    const int at = static_cast<int>(uniform_below(brush.detail, static_cast<uint64_t>(leaf.cols)));
    cv::line(leaf, {at, 0}, {at, leaf.rows}, darker(wood, between(brush.detail, 0.85, 1.06)));
  }
  if (chance(brush.style, 0.4))
    brush.fill_framed(x + 0.3, 1.25, 0.35, 0.6, color(120, 110, 95), darker(wood, 0.7), 0.03);
  brush.fill(x + 0.02, 0, kDoorWidthM - 0.04, 0.2, darker(wood, 0.75));
  const double handle = chance(brush.style, 0.5) ? x + 0.07 : x + kDoorWidthM - 0.19;
  brush.fill(handle, 0.98, 0.12, 0.025, color(200, 200, 200));
  brush.fill(handle + 0.04, 0.9, 0.04, 0.18, color(140, 145, 145));
  const double sign = x + kDoorWidthM + 0.12;
  brush.fill_framed(sign, 1.5, 0.26, 0.2, color(230, 235, 235), color(120, 100, 60), 0.012);
  brush.put_text(sign + 0.03, 1.6, 0.06, fmt::format("{}", 100 + uniform_below(brush.detail, 300)),
                 color(30, 30, 30), 1);
  brush.write(sign + 0.03, 1.52, 0.2, 0.06, 0.025, color(60, 60, 60));
  if (chance(brush.detail, 0.3)) paint_sheet(brush, x + 0.3, 1.3, 0.21, 0.3);
  if (brush.is_changed && chance(brush.day, 0.7)) open_door(brush, x);
}

void paint_lockers(WallBrush& brush, double x, double width) {
  const cv::Scalar steel = any_color(brush.style, 90, 180);
  const double each = 0.36;
  brush.fill_framed(x, 0.08, width, 1.8, darker(steel, 0.8), darker(steel, 0.5), 0.015);
  for (double left = x + 0.02; left + each <= x + width; left += each) {
    brush.fill(left, 0.1, each - 0.02, 1.75, steel);
    for (int slit = 0; slit < 5; ++slit)
      brush.fill(left + 0.08, 1.55 + slit * 0.04, 0.18, 0.012, darker(steel, 0.45));
    brush.fill(left + 0.26, 1.0, 0.03, 0.08, color(50, 50, 50));
    brush.put_text(left + 0.09, 1.42, 0.05, fmt::format("{}", uniform_below(brush.detail, 400)),
                   color(235, 235, 235), 1);
    if (!chance(brush.detail, 0.25)) continue;
    const cv::Scalar sticker = any_color(brush.detail, 40, 250);
    const double bottom = between(brush.detail, 0.4, 1.2);
    brush.fill(left + between(brush.detail, 0.03, 0.2), bottom, 0.1, 0.08, sticker);
  }
}

void paint_radiator(WallBrush& brush, double x, double width) {
  const cv::Scalar white = color(205, 212, 215);
  brush.fill_framed(x, 0.12, width, 0.6, white, darker(white, 0.8), 0.015);
  for (double left = x + 0.03; left < x + width - 0.04; left += 0.06)
    brush.fill(left, 0.15, 0.022, 0.54, darker(white, 0.62));
}

// The view outside in daylight: sky, houses or trees, ground.
void paint_view(WallBrush& brush, double x, double bottom, double width, double height) {
  brush.fill(x, bottom, width, height, opaque(250, 240, 225));
  const double skyline = std::clamp(1.5 - bottom, 0.0, height);
  if (skyline > 0) brush.fill(x, bottom, width, skyline, opaque(110, 150, 130));
  cv::Mat view = brush.part(x, bottom, width, height);
  if (view.empty()) return;
  const int horizon = view.rows - wall_texels(skyline);
  for (int i = 0; i < static_cast<int>(width * 5) + 2; ++i) {
    const int at = static_cast<int>(between(brush.detail, 0, view.cols));
    const int size = wall_texels(between(brush.detail, 0.08, 0.35));
    const double shade = between(brush.detail, 70, 170);
    if (chance(brush.detail, 0.6)) {
      cv::circle(view, {at, horizon - size / 2}, size, opaque(shade * 0.6, shade, shade * 0.8),
                 cv::FILLED, cv::LINE_AA);
    } else {
      cv::rectangle(view, cv::Rect(at, horizon - size, 2 * size, size),
                    opaque(shade, shade * 1.05, shade * 1.15), cv::FILLED);
    }
  }
}

void paint_window(WallBrush& brush, double x, double width) {
  constexpr double kBottom = 0.95, kHeight = 1.45;
  const cv::Scalar frame = color(190, 195, 200);
  brush.fill_framed(x, kBottom, width, kHeight, frame, darker(frame, 0.7), 0.02);
  const double pane = (width - 0.18) / 2;
  for (int i = 0; i < 2; ++i)
    paint_view(brush, x + 0.06 + i * (pane + 0.06), kBottom + 0.06, pane, kHeight - 0.12);
  brush.fill(x - 0.06, kBottom - 0.05, width + 0.12, 0.05, color(215, 220, 222));
  paint_radiator(brush, x + 0.1, width - 0.2);
}

void paint_extinguisher(WallBrush& brush, double x) {
  brush.fill_framed(x, 1.65, 0.2, 0.2, color(40, 40, 200), color(230, 230, 230), 0.012);
  const cv::Rect body = brush.area(x + 0.02, 0.75, 0.16, 0.5);
  cv::rectangle(brush.picture, body, color(35, 30, 190), cv::FILLED);
  cv::rectangle(brush.picture,
                cv::Rect(body.x + body.width / 4, body.y, body.width / 5, body.height),
                color(120, 120, 240), cv::FILLED);
  brush.fill(x + 0.06, 1.25, 0.08, 0.07, color(25, 25, 25));
  brush.write(x + 0.04, 0.9, 0.12, 0.14, 0.03, color(235, 235, 235));
}

void paint_exit_sign(WallBrush& brush, double x) {
  brush.fill_framed(x, 2.3, 0.42, 0.21, color(80, 150, 30), color(225, 230, 225), 0.012);
  const cv::Rect sign = brush.area(x, 2.3, 0.42, 0.21);
  const int y = sign.y + sign.height / 2;
  cv::arrowedLine(brush.picture, {sign.x + sign.width / 5, y}, {sign.x + sign.width * 4 / 5, y},
                  color(240, 245, 240), 5, cv::LINE_AA);
}

void paint_bench(WallBrush& brush, double x, double width) {
  const cv::Scalar wood = any_color(brush.style, 50, 130);
  brush.fill(x, 0.4, width, 0.07, wood);
  brush.fill(x + 0.02, 0.34, width - 0.04, 0.06, darker(wood, 0.5));
  for (const double leg : {0.08, width - 0.14})
    brush.fill(x + leg, 0, 0.06, 0.35, color(40, 40, 42));
}

// Fittings of every wall: a cable duct, sockets, switches and scratches.
void paint_fittings(WallBrush& brush) {
  const cv::Scalar duct = color(185, 190, 192);
  brush.fill(0, 2.55, kSlotM, 0.06, duct);
  brush.fill(0, 2.545, kSlotM, 0.008, darker(duct, 0.5));
  for (int i = 0; i < 2; ++i)
    brush.fill_framed(between(brush.detail, 0.05, 1.8), i == 0 ? 0.3 : 1.1, 0.09, 0.09,
                      color(225, 228, 228), color(140, 142, 142), 0.01);
  for (int i = 0; i < 4; ++i) {
    const double shade = between(brush.detail, 60, 130);
    const double length = between(brush.detail, 0.02, 0.2),
                 bottom = between(brush.detail, 0.1, 1.3);
    brush.fill(between(brush.detail, 0, 1.9), bottom, length, 0.012, color(shade, shade, shade));
  }
}

}  // namespace

void furnish_slot(WallBrush& brush, bool is_hall, bool has_windows) {
  const double what = uniform_unit(brush.style), shift = between(brush.style, 0.1, 0.3);
  if (has_windows && what < 0.7) {
    paint_window(brush, shift, between(brush.style, 1.2, 1.6));
  } else if (what < (is_hall ? 0.15 : 0.42)) {
    paint_door(brush, shift);
  } else if (brush.is_bare) {
    paint_fittings(brush);
    return;
  } else if (what < 0.66) {
    paint_board(brush, shift, is_hall ? 1.6 : between(brush.style, 1.0, 1.6));
  } else if (what < 0.82) {
    paint_poster(brush, shift, between(brush.style, 0.55, 0.85));
    if (chance(brush.style, 0.5)) paint_poster(brush, shift + 0.95, between(brush.style, 0.5, 0.7));
  } else if (what < 0.88) {
    paint_lockers(brush, shift, 1.48);
  } else if (what < 0.93) {
    paint_radiator(brush, shift, 1.2);
    if (chance(brush.detail, 0.5)) paint_sheet(brush, shift + 0.3, 1.3, 0.3, 0.42);
  } else if (what < 0.97) {
    paint_bench(brush, shift, 1.4);
    if (chance(brush.style, 0.7)) paint_poster(brush, shift + 0.2, 0.8);
  }
  if (chance(brush.style, 0.15)) paint_extinguisher(brush, 1.75);
  if (chance(brush.style, 0.12)) paint_exit_sign(brush, 0.5);
  paint_fittings(brush);
  if (brush.is_changed && chance(brush.day, 0.4)) leave_things(brush);
}

void paint_glass_front(WallBrush& brush) {
  const double width = static_cast<double>(brush.picture.cols) / kTexelsPerMeter;
  paint_view(brush, 0, 0, width, kRoomHeightM);
  const cv::Scalar metal = color(70, 72, 75);
  for (double x = 0; x < width + 0.05; x += 1.25)
    brush.fill(x - 0.035, 0, 0.07, kRoomHeightM, metal);
  for (const double z : {0.0, 0.9, 2.2, kRoomHeightM - 0.08}) brush.fill(0, z, width, 0.06, metal);
  for (double x = 0.3; x < width - 0.6; x += 1.25) {
    if (!chance(brush.detail, 0.3)) continue;
    paint_sheet(brush, x, between(brush.detail, 1.1, 1.5), 0.3, 0.42);
  }
}

}  // namespace vpr
