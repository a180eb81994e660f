#include "eval_map.h"

#include <iterator>

#include <fmt/format.h>

#include "base/error.h"
#include "eval_inputs.h"
#include "report/evaluation_report.h"
#include "report/route_map.h"

namespace vpr {
namespace {

MapPanel panel_of(const Evaluated& evaluated) {
  const Evaluation& evaluation = evaluated.evaluation;
  return {title_with_settings(evaluated.report),
          meanings_of(evaluation.judgement, evaluation.truth),
          evaluation.result && evaluation.result->result.places};
}

RouteMap read_map(const Dataset& dataset, const std::string& where, const Evaluation& evaluation) {
  const std::string& name = evaluation.query_name;
  const NamedSequence& query = select_query(dataset, name).sequence;
  if (query.poses.empty())
    throw Error(ErrorKind::usage, fmt::format("{}: the query {} names no \"poses\", which --map "
                                              "needs (CSV frame,x,y)",
                                              where, name));
  RouteMap map;
  std::vector<std::filesystem::path> paths = {query.poses};
  for (const NamedSequence& train : dataset.train)
    if (!train.poses.empty()) paths.push_back(train.poses);
  Routes found = read_routes(paths);
  if (found.is_gps && !(dataset.plan.empty() && dataset.place_poses.empty()))
    throw Error(ErrorKind::data,
                fmt::format("{}: its \"poses\" are latitudes and longitudes, and \"plan\" and "
                            "\"place_poses\" are in metres",
                            where));
  map.query = std::move(found.routes.front());
  map.train.assign(std::make_move_iterator(found.routes.begin() + 1),
                   std::make_move_iterator(found.routes.end()));
  const auto& replay = evaluation.judgement.layout.scope.replay;
  const size_t frames = replay ? replay->recorded_frames : evaluation.judgement.fixes.size();
  if (map.query.empty())
    throw Error(ErrorKind::data, fmt::format("{}: has no poses", query.poses.string()));
  if (map.query.size() > frames)
    throw Error(ErrorKind::data, fmt::format("{}: has poses of {} frames, and the query has {}",
                                             query.poses.string(), map.query.size(), frames));
  map.query.resize(frames);
  if (replay) map.query = replayed(map.query, *replay);
  if (!dataset.plan.empty()) map.walls = read_walls(dataset.plan);
  if (!dataset.place_poses.empty()) map.places = read_place_positions(dataset.place_poses);
  return map;
}

}  // namespace

void add_map_options(const Command& app, MapInputs& inputs) {
  app.add_option("--map", inputs.folder,
                 "draw plan, training paths and recognitions along the query's path as SVG and PNG "
                 "into this folder; needs --dataset with poses")
      .group("Pictures")
      .type_name("FOLDER");
  app.add_option("--map-with", inputs.with,
                 "a second result of the same query, on a map beside the first (FAB-MAP and "
                 "FastABLE, say)")
      .group("Pictures")
      .type_name("RESULT");
}

void check_map_inputs(const Session& session, const MapInputs& inputs, const std::string& dataset) {
  if (inputs.folder.empty()) {
    if (!inputs.with.empty())
      throw Error(ErrorKind::usage, "--map-with needs --map FOLDER, where the map goes");
    return;
  }
  if (dataset.empty())
    throw Error(ErrorKind::usage,
                "--map needs --dataset, whose \"poses\" say where frames were taken");
  session.outputs.claim_folder(inputs.folder, is_marked_folder);
}

void write_map(Session& session, const MapInputs& inputs, const std::string& dataset,
               const Evaluated& first, const Evaluated* second) {
  if (inputs.folder.empty()) return;
  const RouteMap map = read_map(read_dataset(dataset), dataset, first.evaluation);
  std::vector<MapPanel> panels = {panel_of(first)};
  if (second != nullptr) {
    panels.push_back(panel_of(*second));
    const std::string& query = first.evaluation.query_name;
    const std::string& other = second->evaluation.query_name;
    if (other != query || panels[0].meanings.size() != panels[1].meanings.size())
      throw Error(ErrorKind::usage,
                  fmt::format("{}: is of the query {}, the first result of {}; give two results "
                              "of one query",
                              inputs.with, other, query));
  }
  draw_route_map(map, panels, session.outputs.folder(inputs.folder, is_marked_folder).temporary(),
                 session.monitor);
}

}  // namespace vpr
