#include "synth/recording.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <regex>
#include <set>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "base/error.h"
#include "base/json_schema.h"
#include "base/output.h"
#include "base/parallel.h"
#include "synth/scene.h"

namespace vpr {
namespace {

// frame,time,x,y,heading,floor
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

/// The distance to a place, if the camera is on its floor and has a similar heading as one of its
/// views.
std::optional<double> meters_to_place(const std::string& floor, const CameraPose& pose,
                                      const WorldPlace& place) {
  const bool looks_alike = std::ranges::any_of(place.headings, [&](double heading) {
    return heading_difference(pose.heading_deg, heading) <= kSameHeadingDeg;
  });
  if (floor != place.floor || !looks_alike) return std::nullopt;
  return distance(pose.position, {place.x, place.y});
}

// Nullopt for different places.
std::optional<std::string_view> label(double meters, double same_m, double ignore_m) {
  if (meters <= same_m) return "same";
  if (meters <= ignore_m) return "ignore";
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
            kSameHeadingDeg)
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
      const auto meters = meters_to_place(query.walk->floor, query.poses[q], world.places[p]);
      const auto found = meters ? label(*meters, kPlaceRadiusM, kPlaceIgnoreM) : std::nullopt;
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
      const Point end = wall.at(wall.length_m);
      csv += fmt::format("{},{},{},{},{},{}\n", world.floors[i].name, wall.start.x, wall.start.y,
                         end.x, end.y, wall.is_glass ? "glass" : "wall");
    }
  return csv;
}

// Ranges of frames that show no place.
std::vector<std::string> pretraining_ranges(const World& world, const RecordedWalk& recorded) {
  std::vector<std::string> ranges;
  const size_t frames = recorded.poses.size();
  for (size_t first = 0; first < frames;) {
    const auto shows_any = [&](size_t i) {
      return std::ranges::any_of(world.places, [&](const WorldPlace& place) {
        const auto meters = meters_to_place(recorded.walk->floor, recorded.poses[i], place);
        return meters && *meters <= kPlaceIgnoreM;
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
  Json json = {{"schema", schema_name("dataset")},
               {"name", world.name},
               {"fps", world.fps},
               {"plan", "plan.csv"}};
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

namespace fs = std::filesystem;

constexpr int kJpegQuality = 92;

/// The common inputs of all frames of a recording.
struct RenderInputs {
  const World& world;
  Camera camera;
  std::vector<PersonImages> people;
  const Monitor& monitor;
  StepCounter& counter;
};

// Writes a view to `path` without its extension; `noise` names the engine of the sensor noise.
void render_frame(const RenderInputs& inputs, const View& view, const std::string& noise,
                  const fs::path& path) {
  const World& world = inputs.world;
  const cv::Mat picture = render(inputs.camera, view, named_engine(world.seed, noise));
  const std::string extension = fmt::format(".{}", enum_name(world.format));
  std::vector<int> quality;
  if (world.format == FrameFormat::jpg) quality = {cv::IMWRITE_JPEG_QUALITY, kJpegQuality};
  std::vector<uint8_t> bytes;
  cv::imencode(extension, picture, bytes, quality);
  write_part(path.string() + extension, {std::as_bytes(std::span(bytes))});
  inputs.counter.add();
}

void render_walk(const RenderInputs& inputs, const Scene& scene, const RecordedWalk& recorded,
                 const fs::path& folder) {
  const Walk& walk = *recorded.walk;
  make_part_folder(folder);
  const auto figures =
      people_on_walk(inputs.world, walk, scene.plan, recorded.poses, inputs.people.size());
  parallel_for(recorded.poses.size(), inputs.monitor, [&](size_t i) {
    const CameraPose& pose = recorded.poses[i];
    render_frame(inputs,
                 {scene, inputs.people, figures[i], pose, walk.conditions,
                  metered_poses(inputs.world, walk, recorded.poses, i)},
                 fmt::format("noise/{}/{}", walk.name, i), folder / fmt::format("{:05}", i));
  });
  write_part(folder / "poses.csv", poses_csv(recorded));
}

void render_views(const RenderInputs& inputs, const Scene& scene, const WorldPlace& place,
                  const fs::path& folder) {
  make_part_folder(folder);
  for (size_t i = 0; i < place.headings.size(); ++i) {
    const std::string name = fmt::format("view/{}/{}", place.name, i);
    CameraPose pose;
    pose.position = {place.x, place.y};
    pose.heading_deg = place.headings[i];
    render_frame(inputs, {scene, inputs.people, {}, held_on_day(inputs.world, 0, pose), {}, {}},
                 name, folder / std::to_string(i));
  }
}

// Renders one day of a floor after the other, so that only one is in memory.
void render_floor(const RenderInputs& inputs, size_t floor, const std::vector<RecordedWalk>& walks,
                  const fs::path& folder) {
  const World& world = inputs.world;
  const std::string& name = world.floors[floor].name;
  std::set<uint64_t> days;
  for (const Walk& walk : world.walks)
    if (walk.floor == name) days.insert(walk.day);
  for (const WorldPlace& place : world.places)
    if (place.floor == name) days.insert(0);  // of the views of places
  for (const uint64_t day : days) {
    const Scene scene = make_scene(world, floor, inputs.monitor, day);
    for (const RecordedWalk& recorded : walks)
      if (recorded.walk->floor == name && recorded.walk->day == day)
        render_walk(inputs, scene, recorded, folder / recorded.walk->name);
    if (day != 0) continue;
    for (const WorldPlace& place : world.places)
      if (place.floor == name) render_views(inputs, scene, place, folder / "places" / place.name);
  }
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
      throw Error(ErrorKind::usage, "the place {} is inside a wall at x {}, y {}; move it",
                  place.name, place.x, place.y);
  return walks;
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

RecordingSize write_recording(const World& world, const fs::path& folder, const Monitor& monitor) {
  const std::vector<RecordedWalk> walks = record_walks(world);
  RecordingSize size;
  for (const RecordedWalk& recorded : walks) size.frames += recorded.poses.size();
  for (const WorldPlace& place : world.places) size.views += place.headings.size();
  StepCounter counter(monitor, "render", size.frames + size.views);
  const RenderInputs inputs{world, make_camera(world), make_people(world.seed), monitor, counter};
  if (!world.places.empty()) make_part_folder(folder / "places");
  for (size_t floor = 0; floor < world.floors.size(); ++floor)
    render_floor(inputs, floor, walks, folder);
  for (const auto& [name, text] : recording_texts(world, walks)) write_part(folder / name, text);
  return size;
}

bool is_recording_folder(const fs::path& folder) {
  static const std::regex kFile(
      R"((dataset\.json|(places|plan)\.csv|[^/]+\.(ground_truth|places)\.csv|)"
      R"((?!places/)[^/]+/(poses\.csv|[^/]+\.(jpg|png))|places/[^/]+/[^/]+\.(jpg|png)))");
  std::error_code error;
  const auto has_file = [&](const fs::path& path) { return fs::is_regular_file(path, error); };
  if (!has_file(folder / "dataset.json") || !has_file(folder / "plan.csv")) return false;
  const auto is_ours = [&](const fs::directory_entry& entry, int depth) {
    const std::string name = entry.path().lexically_relative(folder).string();
    if (entry.is_symlink(error)) return false;
    if (entry.is_regular_file(error)) return std::regex_match(name, kFile);
    if (depth == 0) return name == "places" || has_file(entry.path() / "poses.csv");
    return depth == 1 && name.starts_with("places/") && entry.is_directory(error);
  };
  std::error_code failure;
  for (fs::recursive_directory_iterator it(folder, failure), end; !failure && it != end;
       it.increment(failure))
    if (!is_ours(*it, it.depth())) return false;
  if (failure)
    throw Error(ErrorKind::output, "{}: can't be read: {}", folder.string(),
                system_error_text(failure.value()));
  return true;
}

namespace {

struct WorldInfo {
  size_t walks = 0, frames = 0, places = 0, views = 0;
};

VPR_FILE(WorldInfo, "world-info", (walks, "Walks that were rendered."),
         (frames, "Frames of all walks."), (places, "Places of FAB-MAP."),
         (views, "Views of all places."))

}  // namespace

Json recording_json(const World& world, const RecordingSize& size) {
  return value_to_json(WorldInfo{world.walks.size(), size.frames, world.places.size(), size.views},
                       kDataForm);
}

Json world_schema() {
  SchemaVisitor visit{SchemaForm::partial};
  visit("schema", Derived{schema_name("world")});
  World world;
  visit_fields(world, visit);
  return visit.object;
}

Json world_info_schema() { return schema_of<WorldInfo>(); }

}  // namespace vpr
