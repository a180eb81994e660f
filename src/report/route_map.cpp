#include "report/route_map.h"

#include <algorithm>

#include <fmt/format.h>

#include "report/plot.h"

namespace vpr {
namespace {

// Readable for people who do not see red and green apart: shapes and brightness differ, too.
constexpr const char* kWall = "#444444";
constexpr const char* kTrain = "#9db8d2";
constexpr const char* kPlace = "#2255aa";
constexpr const char* kUnmapped = "#bbbbbb";
constexpr const char* kMissed = "#e0a800";
constexpr const char* kRight = "#1a8f3c";
constexpr const char* kWrong = "#d01c1c";

PlotLine points(const std::string& name, const char* colour, PlotMark mark) {
  PlotLine line{name, {}, PlotStyle::points};
  line.colour = colour;
  line.mark = mark;
  return line;
}

PlotLine wall_lines(const RouteMap& map, const std::string& floor) {
  PlotLine line{"", {}, PlotStyle::line};
  line.colour = kWall;
  for (const WallLine& wall : map.walls) {
    if (wall.from.floor != floor) continue;
    line.points.insert(line.points.end(),
                       {{wall.from.x, wall.from.y}, {wall.to.x, wall.to.y}, kPlotGap});
  }
  return line;
}

Plot panel_plot(const RouteMap& map, const MapPanel& panel, const std::string& floor) {
  Plot plot;
  plot.title = floor.empty() ? panel.title : fmt::format("{}, {}", panel.title, floor);
  plot.is_plan = true;
  PlotLine train = points("training path", kTrain, PlotMark::dot);
  for (const auto& sequence : map.train)
    for (const auto& at : sequence)
      if (at && at->floor == floor) train.points.emplace_back(at->x, at->y);
  PlotLine places = points("training place", kPlace, PlotMark::square);
  for (const RoutePoint& place : map.places)
    if (place.floor == floor) places.points.emplace_back(place.x, place.y);
  PlotLine unmapped = points("nothing to recognise", kUnmapped, PlotMark::dot);
  PlotLine missed = points("not recognised", kMissed, PlotMark::dot);
  PlotLine right = points("correct", kRight, PlotMark::disc);
  PlotLine wrong = points("incorrect", kWrong, PlotMark::cross);
  for (size_t frame = 0; frame < map.query.size(); ++frame) {
    const auto& at = map.query[frame];
    if (!at || at->floor != floor) continue;
    PlotLine& line = panel.fixes[frame] == Fix::right   ? right
                     : panel.fixes[frame] == Fix::wrong ? wrong
                     : panel.has_match[frame]           ? missed
                                                        : unmapped;
    line.points.emplace_back(at->x, at->y);
  }
  plot.lines = {wall_lines(map, floor), train, unmapped, missed, places, right, wrong};
  std::erase_if(plot.lines, [](const PlotLine& line) { return line.points.empty(); });
  return plot;
}

}  // namespace

void draw_route_map(const RouteMap& map, const std::vector<MapPanel>& panels,
                    const std::filesystem::path& folder) {
  std::vector<std::string> floors;
  for (const auto& at : map.query)
    if (at && std::find(floors.begin(), floors.end(), at->floor) == floors.end())
      floors.push_back(at->floor);
  std::vector<Plot> plots;
  for (const std::string& floor : floors)
    for (const MapPanel& panel : panels) plots.push_back(panel_plot(map, panel, floor));
  draw_plots(plots, panels.size(), "map", folder);
}

}  // namespace vpr
