#include "report/route_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>

#include "report/frame_axis.h"

namespace vpr {
namespace {

PlotLine points(Meaning meaning, PlotMark mark) {
  return {std::string(colour_of(meaning).words), {}, PlotStyle::points, hex_of(meaning), mark};
}

PlotLine line(Meaning meaning, PlotStyle style) {
  return {std::string(colour_of(meaning).words), {}, style, hex_of(meaning)};
}

PlotLine wall_lines(const RouteMap& map, const std::string& floor) {
  PlotLine walls = line(Meaning::wall, PlotStyle::line);
  for (const WallLine& wall : map.walls) {
    if (wall.from.floor != floor) continue;
    walls.points.insert(walls.points.end(),
                        {{wall.from.x, wall.from.y}, {wall.to.x, wall.to.y}, kPlotGap});
  }
  return walls;
}

/// A wide line, so that the query's dots can be seen on it.
PlotLine train_lines(const RouteMap& map, const std::string& floor) {
  PlotLine train = line(Meaning::train_path, PlotStyle::wide_line);
  for (const auto& sequence : map.train) {
    for (const auto& at : sequence)
      train.points.push_back(at && at->floor == floor ? std::pair(at->x, at->y) : kPlotGap);
    train.points.push_back(kPlotGap);
  }
  const bool is_empty = std::all_of(train.points.begin(), train.points.end(),
                                    [](const auto& point) { return std::isnan(point.first); });
  if (is_empty) train.points.clear();
  return train;
}

/// Below what is drawn: about a quarter of its width, in round metres.
PlotLine scale_bar(const std::vector<PlotLine>& lines) {
  double left = std::numeric_limits<double>::infinity();
  double right = -left;
  double bottom = left;
  double top = -left;
  for (const PlotLine& drawn : lines)
    for (const auto& [x, y] : drawn.points) {
      if (std::isnan(x)) continue;
      left = std::min(left, x);
      right = std::max(right, x);
      bottom = std::min(bottom, y);
      top = std::max(top, y);
    }
  PlotLine bar{"", {}, PlotStyle::bar, hex_of(Meaning::wall)};
  if (right <= left && top <= bottom) return bar;
  const double size = std::max(right - left, top - bottom);
  const auto metres = static_cast<double>(round_step(static_cast<size_t>(size), 4));
  const double y = bottom - 0.06 * size;
  bar.points = {{left, y}, {left + metres, y}};
  bar.labels = {"", fmt::format("{} m", metres)};
  return bar;
}

using MarkedMeaning = std::pair<Meaning, PlotMark>;

// In the order in which they are drawn.
constexpr std::array<MarkedMeaning, 3> kBelowPlaces = {{{Meaning::unmapped, PlotMark::circle},
                                                        {Meaning::unreachable, PlotMark::dot},
                                                        {Meaning::missed, PlotMark::dot}}};
constexpr std::array<MarkedMeaning, 3> kAbovePlaces = {{{Meaning::unjudged, PlotMark::disc},
                                                        {Meaning::right, PlotMark::disc},
                                                        {Meaning::wrong, PlotMark::cross}}};

PlotLine frame_points(const RouteMap& map, const MapPanel& panel, const std::string& floor,
                      Meaning meaning, PlotMark mark) {
  PlotLine frames = points(meaning, mark);
  for (size_t frame = 0; frame < map.query.size(); ++frame) {
    const auto& at = map.query[frame];
    if (at && at->floor == floor && panel.meanings[frame] == meaning)
      frames.points.emplace_back(at->x, at->y);
  }
  return frames;
}

Plot panel_plot(const RouteMap& map, const MapPanel& panel, const std::string& floor) {
  Plot plot;
  plot.title = floor.empty() ? panel.title : fmt::format("{}, {}", panel.title, floor);
  plot.is_plan = true;
  PlotLine places = points(Meaning::place, PlotMark::square);
  if (panel.shows_places)
    for (const RoutePoint& place : map.places)
      if (place.floor == floor) places.points.emplace_back(place.x, place.y);
  plot.lines = {train_lines(map, floor), wall_lines(map, floor)};
  for (const auto& [meaning, mark] : kBelowPlaces)
    plot.lines.push_back(frame_points(map, panel, floor, meaning, mark));
  plot.lines.push_back(places);
  for (const auto& [meaning, mark] : kAbovePlaces)
    plot.lines.push_back(frame_points(map, panel, floor, meaning, mark));
  plot.lines.push_back(scale_bar(plot.lines));
  std::erase_if(plot.lines, [](const PlotLine& drawn) { return drawn.points.empty(); });
  return plot;
}

}  // namespace

std::vector<Meaning> meanings_of(const Judgement& judgement, const GroundTruth& truth) {
  std::vector<Meaning> meanings;
  for (size_t frame = 0; frame < judgement.fixes.size(); ++frame)
    meanings.push_back(truth.has_match(frame) ? Meaning::unreachable : Meaning::unmapped);
  for (const QueryOutcome& query : judgement.outcomes.queries)
    if (query.has_match && query.verdict != Verdict::unreadable)
      meanings[query.frame] = Meaning::missed;
  for (size_t frame = 0; frame < judgement.fixes.size(); ++frame) {
    if (judgement.fixes[frame] == Fix::right) meanings[frame] = Meaning::right;
    if (judgement.fixes[frame] == Fix::wrong) meanings[frame] = Meaning::wrong;
    if (judgement.fixes[frame] == Fix::unjudged) meanings[frame] = Meaning::unjudged;
  }
  return meanings;
}

std::vector<Plot> route_plots(const RouteMap& map, const std::vector<MapPanel>& panels,
                              const Monitor& monitor) {
  std::vector<std::string> floors;
  std::set<std::string> known;
  for (const auto& at : map.query)
    if (at && known.insert(at->floor).second) floors.push_back(at->floor);
  std::vector<Plot> plots;
  for (const std::string& floor : floors)
    for (const MapPanel& panel : panels) {
      check_stop(monitor);
      plots.push_back(panel_plot(map, panel, floor));
    }
  return plots;
}

void draw_route_map(const RouteMap& map, const std::vector<MapPanel>& panels,
                    const std::filesystem::path& folder, const Monitor& monitor) {
  draw_plots(route_plots(map, panels, monitor), panels.size(), "map", folder);
}

}  // namespace vpr
