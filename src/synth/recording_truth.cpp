#include "synth/recording_truth.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

#include <fmt/format.h>

#include "base/error.h"
#include "base/json.h"

namespace vpr {
namespace {

/// Metres from a place, if the camera is on its floor and looks as one of its views does.
std::optional<double> metres_to_place(const World& world, const std::string& floor,
                                      const CameraPose& pose, const WorldPlace& place) {
  const bool looks_alike =
      std::any_of(place.headings.begin(), place.headings.end(), [&](double heading) {
        return heading_difference(pose.heading_deg, heading) <= world.same_heading_deg;
      });
  if (floor != place.floor || !looks_alike) return std::nullopt;
  return distance(pose.position, {place.x, place.y});
}

// Nothing for different places.
std::optional<std::string_view> label(double metres, double same_m, double ignore_m) {
  if (metres <= same_m) return "same";
  if (metres <= ignore_m) return "ignore";
  return std::nullopt;
}

std::string sequence_truth_csv(const World& world, const std::vector<RecordedWalk>& walks,
                               const RecordedWalk& query) {
  std::string csv = "query,sequence,reference,label\n";
  for (size_t q = 0; q < query.poses.size(); ++q)
    for (const RecordedWalk& train : walks) {
      if (train.walk->use != WalkUse::train || train.walk->floor != query.walk->floor) continue;
      for (size_t r = 0; r < train.poses.size(); ++r) {
        if (heading_difference(query.poses[q].heading_deg, train.poses[r].heading_deg) >
            world.same_heading_deg)
          continue;
        const auto found = label(distance(query.poses[q].position, train.poses[r].position),
                                 world.same_place_m, world.ignore_m);
        if (found) csv += fmt::format("{},{},{},{}\n", q, train.walk->name, r, *found);
      }
    }
  return csv;
}

std::string place_truth_csv(const World& world, const RecordedWalk& query) {
  std::string csv = "query,reference,label\n";
  for (size_t q = 0; q < query.poses.size(); ++q)
    for (size_t p = 0; p < world.places.size(); ++p) {
      const auto metres =
          metres_to_place(world, query.walk->floor, query.poses[q], world.places[p]);
      const auto found =
          metres ? label(*metres, world.place_radius_m, world.place_ignore_m) : std::nullopt;
      if (found) csv += fmt::format("{},{},{}\n", q, p, *found);
    }
  return csv;
}

std::string places_csv(const World& world) {
  std::string csv = "place,view,x,y,heading,floor\n";
  for (const WorldPlace& place : world.places)
    for (size_t view = 0; view < place.headings.size(); ++view)
      csv +=
          fmt::format("{0},places/{0}/{1}.{2},{3},{4},{5},{6}\n", place.name, view,
                      enum_name(world.format), place.x, place.y, place.headings[view], place.floor);
  return csv;
}

std::string plan_csv(const World& world) {
  std::string csv = "floor,x0,y0,x1,y1,kind\n";
  for (size_t i = 0; i < world.floors.size(); ++i)
    for (const Wall& wall : make_floor_plan(plan_floor(world, i)).walls) {
      const Point way = wall_direction(wall.side);
      csv += fmt::format("{},{},{},{},{},{}\n", world.floors[i].name, wall.start.x, wall.start.y,
                         wall.start.x + wall.length_m * way.x, wall.start.y + wall.length_m * way.y,
                         wall.is_glass ? "glass" : "wall");
    }
  return csv;
}

// Ranges of frames that show no place.
std::vector<std::string> pretraining_ranges(const World& world, const RecordedWalk& recorded) {
  std::vector<std::string> ranges;
  const size_t frames = recorded.poses.size();
  for (size_t first = 0; first < frames;) {
    const auto shows_any = [&](size_t i) {
      return std::any_of(world.places.begin(), world.places.end(), [&](const WorldPlace& place) {
        const auto metres = metres_to_place(world, recorded.walk->floor, recorded.poses[i], place);
        return metres && *metres <= std::max(world.place_radius_m, world.place_ignore_m);
      });
    };
    size_t last = first;
    while (last < frames && !shows_any(last)) ++last;
    if (last > first)
      ranges.push_back(last - first == frames
                           ? recorded.walk->name
                           : fmt::format("{}@{}:{}", recorded.walk->name, first, last));
    first = last + 1;
  }
  return ranges;
}

Json dataset_json(const World& world, const std::vector<RecordedWalk>& walks) {
  Json json = {
      {"schema", "vpr.dataset/1"}, {"name", world.name}, {"fps", world.fps}, {"plan", "plan.csv"}};
  for (const RecordedWalk& recorded : walks)
    if (recorded.walk->use == WalkUse::pretrain)
      for (const std::string& range : pretraining_ranges(world, recorded))
        json["pretrain"].push_back(range);
  const auto named = [](const Walk& walk) {
    return Json{{"name", walk.name}, {"sequence", walk.name}, {"poses", walk.name + "/poses.csv"}};
  };
  json["train"] = Json::array();
  for (const Walk& walk : world.walks)
    if (walk.use == WalkUse::train) json["train"].push_back(named(walk));
  if (!world.places.empty()) json["place_poses"] = "places.csv";
  for (const WorldPlace& place : world.places)
    json["places"].push_back(
        {{"name", place.name}, {"sequences", Json::array({"places/" + place.name})}});
  json["queries"] = Json::array();
  for (const Walk& walk : world.walks) {
    if (walk.use != WalkUse::query) continue;
    Json query = named(walk);
    query["ground_truth"] = {{"format", "pairs"}, {"path", walk.name + ".ground_truth.csv"}};
    if (!world.places.empty())
      query["place_ground_truth"] = {{"format", "pairs"}, {"path", walk.name + ".places.csv"}};
    json["queries"].push_back(query);
  }
  return json;
}

}  // namespace

std::vector<RecordedWalk> record_walks(const World& world) {
  std::vector<FloorPlan> plans;
  for (size_t i = 0; i < world.floors.size(); ++i)
    plans.push_back(make_floor_plan(plan_floor(world, i)));
  std::vector<RecordedWalk> walks;
  for (const Walk& walk : world.walks)
    walks.push_back({&walk, walk_poses(world, walk, plans[floor_index(world, walk.floor)])});
  for (const WorldPlace& place : world.places)
    if (!plans[floor_index(world, place.floor)].is_open({place.x, place.y}))
      throw Error(ErrorKind::usage,
                  fmt::format("the place {} stands in a wall at x {}, y {}; move it", place.name,
                              place.x, place.y));
  return walks;
}

CameraPose view_pose(const WorldPlace& place, size_t view) {
  CameraPose pose;
  pose.position = {place.x, place.y};
  pose.heading_deg = place.headings[view];
  return pose;
}

std::string poses_csv(const RecordedWalk& recorded) {
  std::string csv = "frame,time,x,y,heading,floor\n";
  for (size_t i = 0; i < recorded.poses.size(); ++i) {
    const CameraPose& pose = recorded.poses[i];
    csv += fmt::format("{},{:.3f},{:.3f},{:.3f},{:.2f},{}\n", i, pose.time_s, pose.position.x,
                       pose.position.y, std::fmod(std::round(pose.heading_deg * 100) / 100, 360),
                       recorded.walk->floor);
  }
  return csv;
}

std::vector<std::pair<std::string, std::string>> recording_texts(
    const World& world, const std::vector<RecordedWalk>& walks) {
  std::vector<std::pair<std::string, std::string>> texts = {{"plan.csv", plan_csv(world)}};
  if (!world.places.empty()) texts.emplace_back("places.csv", places_csv(world));
  for (const RecordedWalk& recorded : walks) {
    if (recorded.walk->use != WalkUse::query) continue;
    texts.emplace_back(recorded.walk->name + ".ground_truth.csv",
                       sequence_truth_csv(world, walks, recorded));
    if (!world.places.empty())
      texts.emplace_back(recorded.walk->name + ".places.csv", place_truth_csv(world, recorded));
  }
  texts.emplace_back("dataset.json", to_text(dataset_json(world, walks)));
  return texts;
}

}  // namespace vpr
