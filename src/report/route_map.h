// A map of recognitions as in the paper's figures: plan, training paths, and the query's path with
// what was recognised where.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "evaluation/localisation.h"
#include "evaluation/route.h"
#include "report/plot.h"

namespace vpr {

/// One result on the map.
struct MapPanel {
  std::string title;
  std::vector<Fix> fixes;       ///< one a query frame
  std::vector<bool> has_match;  ///< whether the ground truth has the frame's place
  bool shows_places = false;    ///< of FAB-MAP: the map's places are its training data, too
};

struct RouteMap {
  std::vector<WallLine> walls;
  std::vector<std::vector<std::optional<RoutePoint>>> train;  ///< by sequence
  std::vector<RoutePoint> places;
  std::vector<std::optional<RoutePoint>> query;
};

/// The panels, row by row: side by side, and one below the other for every floor that the query
/// visits. Training paths and places of other floors are left out. Each has a bar of so many
/// metres.
std::vector<Plot> route_plots(const RouteMap& map, const std::vector<MapPanel>& panels);

/// Draws map.svg and map.png into `folder`, which exists. Throws Error(output) if gnuplot fails.
void draw_route_map(const RouteMap& map, const std::vector<MapPanel>& panels,
                    const std::filesystem::path& folder);

}  // namespace vpr
