// A map of recognitions as in the paper's figures: plan, training paths, and the query's path with
// what was recognized where.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "evaluate/judgment.h"
#include "present/chart.h"
#include "present/palette.h"
#include "truth/route.h"

namespace vpr {

/// One result on the map.
struct MapPanel {
  std::string title;
  std::vector<Meaning> meanings;  ///< one a query frame: meanings_of
  bool shows_places = false;      ///< of FAB-MAP: the map's places are its training data, too
};

/// What a map shows.
struct RouteMap {
  std::vector<WallLine> walls;
  std::vector<std::vector<std::optional<RoutePoint>>> train;  ///< by sequence
  std::vector<RoutePoint> places;
  std::vector<std::optional<RoutePoint>> query;
};

/// What each query frame is on a map: recognized (right, wrong, unjudged), or why not. Missed: its
/// place could have been recognized. Unreachable: the ground truth has its place, but no window of
/// the query ends at the frame, or none of a training sequence where the place is, or the frame's
/// window can't be read. Unmapped: the ground truth does not have it.
std::vector<Meaning> meanings_of(const Judgment& judgment, const GroundTruth& truth);

/// A bar of round meters below what is drawn, about a quarter as wide; without points where that is
/// one spot.
Series scale_bar(const std::vector<Series>& lines);

/// The panels, row by row: side by side, and one below the other for every floor that the query
/// visits. Training paths and places of other floors are left out. Each has a bar of so many
/// meters.
std::vector<Chart> route_charts(const RouteMap& map, const std::vector<MapPanel>& panels,
                                const Monitor& monitor = {});

/// Draws map.svg and map.png into the folder of an output. Throws Error(output).
void draw_route_map(const RouteMap& map, const std::vector<MapPanel>& panels,
                    const std::filesystem::path& folder, const Monitor& monitor);

}  // namespace vpr
