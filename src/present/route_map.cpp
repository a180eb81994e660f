#include "present/route_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "present/chart_layout.h"

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

/// A wide line, so that the query's dots can be seen on it.
Series train_lines(const RouteMap& map, const std::string& floor) {
  Series train = series_of(Meaning::train_path, SeriesStyle::wide_line);
  for (const auto& sequence : map.train) {
    for (const auto& at : sequence)
      train.points.push_back(at && at->floor == floor ? std::pair(at->x, at->y) : kChartGap);
    train.points.push_back(kChartGap);
  }
  const bool is_empty = std::all_of(train.points.begin(), train.points.end(),
                                    [](const auto& point) { return std::isnan(point.first); });
  if (is_empty) train.points.clear();
  return train;
}

using MarkedMeaning = std::pair<Meaning, SeriesMark>;

// In the order in which they are drawn.
constexpr std::array<MarkedMeaning, 3> kBelowPlaces = {{{Meaning::unmapped, SeriesMark::circle},
                                                        {Meaning::unreachable, SeriesMark::dot},
                                                        {Meaning::missed, SeriesMark::dot}}};
constexpr std::array<MarkedMeaning, 3> kAbovePlaces = {{{Meaning::unjudged, SeriesMark::disc},
                                                        {Meaning::right, SeriesMark::disc},
                                                        {Meaning::wrong, SeriesMark::cross}}};

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
  Chart chart;
  chart.title = floor.empty() ? panel.title : fmt::format("{}, {}", panel.title, floor);
  chart.is_plan = true;
  chart.y.from_zero = false;
  chart.width = 675;
  Series places = series_of(Meaning::place, SeriesStyle::points, SeriesMark::square);
  if (panel.shows_places)
    for (const RoutePoint& place : map.places)
      if (place.floor == floor) places.points.emplace_back(place.x, place.y);
  chart.series = {train_lines(map, floor), wall_lines(map, floor)};
  for (const auto& [meaning, mark] : kBelowPlaces)
    chart.series.push_back(frame_points(map, panel, floor, meaning, mark));
  chart.series.push_back(places);
  for (const auto& [meaning, mark] : kAbovePlaces)
    chart.series.push_back(frame_points(map, panel, floor, meaning, mark));
  chart.series.push_back(scale_bar(chart.series));
  std::erase_if(chart.series, [](const Series& drawn) { return drawn.points.empty(); });
  return chart;
}

}  // namespace

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
  Series bar{"", {}, SeriesStyle::bar, Meaning::wall};
  if (right <= left && top <= bottom) return bar;
  const double size = std::max(right - left, top - bottom);
  const auto meters = static_cast<double>(round_step(static_cast<size_t>(size), 4));
  const double y = bottom - 0.06 * size;
  bar.points = {{left, y}, {left + meters, y}};
  bar.labels = {"", fmt::format("{} m", meters)};
  return bar;
}

std::vector<Meaning> meanings_of(const Judgment& judgment, const GroundTruth& truth) {
  std::vector<Meaning> meanings;
  for (size_t frame = 0; frame < judgment.fixes.size(); ++frame)
    meanings.push_back(truth.has_match(frame) ? Meaning::unreachable : Meaning::unmapped);
  for (const QueryOutcome& query : judgment.outcomes.queries)
    if (query.has_match && query.verdict != Verdict::unreadable)
      meanings[query.frame] = Meaning::missed;
  for (size_t frame = 0; frame < judgment.fixes.size(); ++frame)
    if (judgment.fixes[frame] != Fix::none) meanings[frame] = meaning_of(judgment.fixes[frame]);
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
