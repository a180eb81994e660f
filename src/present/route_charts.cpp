// Maps of routes and recognitions, as in the paper's figures.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "present/evaluation_charts.h"

namespace vpr {
namespace {

Series wall_lines(const RouteMap& map, const std::string& floor) {
  Series walls = series_of(Meaning::wall, SeriesStyle::line);
  for (const WallLine& wall : map.walls) {
    if (wall.from.floor != floor) continue;
    walls.points.insert(walls.points.end(),
                        {{wall.from.x, wall.from.y}, {wall.to.x, wall.to.y}, kChartGap});
  }
  return walls;
}

/// A wide line, on which the query's dots are visible.
Series train_lines(const RouteMap& map, const std::string& floor) {
  Series train = series_of(Meaning::train_path, SeriesStyle::wide_line);
  for (const auto& sequence : map.train) {
    for (const auto& at : sequence)
      train.points.push_back(at && at->floor == floor ? std::pair(at->x, at->y) : kChartGap);
    train.points.push_back(kChartGap);
  }
  if (std::ranges::all_of(train.points, [](const auto& point) { return std::isnan(point.first); }))
    train.points.clear();
  return train;
}

// Query frames and training places, in the order of drawing.
constexpr std::array<std::pair<Meaning, SeriesMark>, 6> kPoints = {
    {{Meaning::unmapped, SeriesMark::circle},
     {Meaning::missed, SeriesMark::dot},
     {Meaning::place, SeriesMark::square},
     {Meaning::unjudged, SeriesMark::disc},
     {Meaning::correct, SeriesMark::disc},
     {Meaning::incorrect, SeriesMark::cross}}};

Series frame_points(const RouteMap& map, const MapPanel& panel, const std::string& floor,
                    Meaning meaning, SeriesMark mark) {
  Series frames = series_of(meaning, SeriesStyle::points, mark);
  for (size_t frame = 0; frame < map.query.size(); ++frame) {
    const auto& at = map.query[frame];
    if (at && at->floor == floor && panel.meanings[frame] == meaning)
      frames.points.emplace_back(at->x, at->y);
  }
  return frames;
}

Chart panel_chart(const RouteMap& map, const MapPanel& panel, const std::string& floor) {
  std::vector<Series> series = {train_lines(map, floor), wall_lines(map, floor)};
  for (const auto& [meaning, mark] : kPoints) {
    series.push_back(frame_points(map, panel, floor, meaning, mark));
    if (meaning != Meaning::place || !panel.shows_places) continue;
    for (const RoutePoint& place : map.places)
      if (place.floor == floor) series.back().points.emplace_back(place.x, place.y);
  }
  return plan_chart("", floor.empty() ? panel.title : fmt::format("{}, {}", panel.title, floor),
                    std::move(series));
}

// Below the lines; empty if these are one point.
Series scale_bar(const std::vector<Series>& lines) {
  double left = std::numeric_limits<double>::infinity();
  double right = -left;
  double bottom = left;
  double top = -left;
  for (const Series& drawn : lines)
    for (const auto& [x, y] : drawn.points) {
      if (std::isnan(x)) continue;
      left = std::min(left, x);
      right = std::max(right, x);
      bottom = std::min(bottom, y);
      top = std::max(top, y);
    }
  Series bar{"", {}, SeriesStyle::line, Meaning::wall};
  if (right <= left && top <= bottom) return bar;
  const double size = std::max(right - left, top - bottom);
  const auto meters = static_cast<double>(round_step(static_cast<size_t>(size), 4));
  const double y = bottom - 0.06 * size;
  bar.points = {{left, y}, {left + meters, y}};
  bar.labels = {"", fmt::format("{} m", meters)};
  return bar;
}

}  // namespace

Chart plan_chart(const std::string& file, const std::string& title, std::vector<Series> series) {
  Chart chart{file, title};
  chart.is_plan = true;
  chart.y.from_zero = false;
  chart.width = 675;
  chart.series = std::move(series);
  chart.series.push_back(scale_bar(chart.series));
  erase_empty_series(chart);
  return chart;
}

std::vector<Meaning> meanings_of(const Judgment& judgment, const GroundTruth& truth) {
  std::vector<Meaning> meanings;
  for (size_t frame = 0; frame < judgment.verdicts.size(); ++frame) {
    const Verdict verdict = judgment.verdicts[frame];
    const bool has_place = truth.has_match(frame) || !truth.is_known;
    meanings.push_back(verdict != Verdict::none ? meaning_of(verdict)
                       : has_place              ? Meaning::missed
                                                : Meaning::unmapped);
  }
  return meanings;
}

std::vector<Chart> route_charts(const RouteMap& map, const std::vector<MapPanel>& panels,
                                const Monitor& monitor) {
  std::vector<std::string> floors;
  std::set<std::string> known;
  for (const auto& at : map.query)
    if (at && known.insert(at->floor).second) floors.push_back(at->floor);
  std::vector<Chart> charts;
  for (const std::string& floor : floors)
    for (const MapPanel& panel : panels) {
      check_stop(monitor);
      charts.push_back(panel_chart(map, panel, floor));
    }
  return charts;
}

void draw_route_map(const RouteMap& map, const std::vector<MapPanel>& panels,
                    const std::filesystem::path& folder, const Monitor& monitor) {
  draw_charts(route_charts(map, panels, monitor), panels.size(), "map", folder);
}

}  // namespace vpr
