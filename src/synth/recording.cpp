#include "synth/recording.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "base/json.h"
#include "base/output.h"
#include "base/parallel.h"
#include "synth/recording_truth.h"
#include "synth/renderer.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr int kJpegQuality = 92;

std::string extension(const World& world) {
  return world.format == FrameFormat::jpg ? ".jpg" : ".png";
}

void write_frame(const World& world, const cv::Mat& picture, const fs::path& path) {
  std::vector<uint8_t> bytes;
  cv::imencode(path.extension().string(), picture, bytes,
               world.format == FrameFormat::jpg
                   ? std::vector<int>{cv::IMWRITE_JPEG_QUALITY, kJpegQuality}
                   : std::vector<int>{});
  write_part(path, {std::as_bytes(std::span(bytes))});
}

/// What all frames of a recording share.
struct Studio {
  const World& world;
  Camera camera;
  std::vector<Looks> cast;
  const Monitor& monitor;
  StepCounter& counter;
};

void render_walk(const Studio& studio, const Scene& scene, const RecordedWalk& recorded,
                 const fs::path& folder) {
  const Walk& walk = *recorded.walk;
  make_part_folder(folder);
  const Crowd crowd(studio.world, walk, scene.plan, recorded.poses, studio.cast.size());
  parallel_for(recorded.poses.size(), studio.monitor, [&](size_t i) {
    const CameraPose& pose = recorded.poses[i];
    const View view{scene, studio.cast,     crowd.at(pose.time_s),
                    pose,  walk.conditions, metered_poses(studio.world, walk, recorded.poses, i)};
    const cv::Mat picture =
        render(studio.camera, view,
               named_engine(studio.world.seed, fmt::format("noise/{}/{}", walk.name, i)));
    write_frame(studio.world, picture, folder / fmt::format("{:05}{}", i, extension(studio.world)));
    studio.counter.add();
  });
  write_part(folder / "poses.csv", poses_csv(recorded));
}

void render_views(const Studio& studio, const Scene& scene, const WorldPlace& place,
                  const fs::path& folder) {
  make_part_folder(folder);
  for (size_t i = 0; i < place.headings.size(); ++i) {
    const CameraPose held =
        held_by(studio.world, fmt::format("view/{}/{}", place.name, i), view_pose(place, i));
    const View view{scene, studio.cast, {}, held, Conditions(), {}};
    const cv::Mat picture =
        render(studio.camera, view,
               named_engine(studio.world.seed, fmt::format("view/{}/{}", place.name, i)));
    write_frame(studio.world, picture, folder / fmt::format("{}{}", i, extension(studio.world)));
    studio.counter.add();
  }
}

// The days on which a floor is seen; views of places are of day 0.
std::set<uint64_t> days_of(const World& world, const std::string& floor) {
  std::set<uint64_t> days;
  for (const Walk& walk : world.walks)
    if (walk.floor == floor) days.insert(walk.day);
  for (const WorldPlace& place : world.places)
    if (place.floor == floor) days.insert(0);
  return days;
}

// One floor and day after the other, so that no more than one is painted and in memory.
void render_floor(const Studio& studio, size_t floor, const std::vector<RecordedWalk>& walks,
                  const fs::path& folder) {
  const World& world = studio.world;
  const std::string& name = world.floors[floor].name;
  for (const uint64_t day : days_of(world, name)) {
    const Scene scene = make_scene(world, floor, studio.monitor, day);
    for (const RecordedWalk& recorded : walks)
      if (recorded.walk->floor == name && recorded.walk->day == day)
        render_walk(studio, scene, recorded, folder / recorded.walk->name);
    if (day != 0) continue;
    for (const WorldPlace& place : world.places)
      if (place.floor == name) render_views(studio, scene, place, folder / "places" / place.name);
  }
}

// Whether a folder holds frames, and at most the one other file.
bool holds_frames(const fs::path& folder, std::string_view other = "") {
  return holds_only_files(folder, [&](const std::string& name) {
    return name.ends_with(".jpg") || name.ends_with(".png") || name == other;
  });
}

bool is_walk_folder(const fs::path& folder) {
  std::error_code error;
  return fs::is_regular_file(folder / "poses.csv", error) && holds_frames(folder, "poses.csv");
}

bool is_places_folder(const fs::path& folder) {
  const auto places = entries_of(folder);
  return std::all_of(places.begin(), places.end(), [](const fs::directory_entry& place) {
    std::error_code error;
    return place.is_directory(error) && holds_frames(place.path());
  });
}

bool is_recording_text(const std::string& name) {
  return name == "dataset.json" || name == "places.csv" || name == "plan.csv" ||
         name.ends_with(".ground_truth.csv") || name.ends_with(".places.csv");
}

}  // namespace

RecordingSize write_recording(const World& world, const fs::path& folder, const Monitor& monitor) {
  const std::vector<RecordedWalk> walks = record_walks(world);
  RecordingSize size;
  for (const RecordedWalk& recorded : walks) size.frames += recorded.poses.size();
  for (const WorldPlace& place : world.places) size.views += place.headings.size();
  StepCounter counter(monitor, "render", size.frames + size.views);
  const Studio studio{world, make_camera(world), make_cast(world.seed), monitor, counter};
  if (!world.places.empty()) make_part_folder(folder / "places");
  for (size_t floor = 0; floor < world.floors.size(); ++floor)
    render_floor(studio, floor, walks, folder);
  for (const auto& [name, text] : recording_texts(world, walks)) write_part(folder / name, text);
  return size;
}

bool is_recording_folder(const fs::path& folder) {
  std::error_code error;
  for (const char* name : {"dataset.json", "plan.csv"})
    if (!fs::is_regular_file(folder / name, error)) return false;
  for (const fs::directory_entry& entry : entries_of(folder)) {
    const std::string name = entry.path().filename().string();
    const bool is_ours = !entry.is_directory(error) ? is_recording_text(name)
                         : name == "places"         ? is_places_folder(entry.path())
                                                    : is_walk_folder(entry.path());
    if (!is_ours) return false;
  }
  return true;
}

Json recording_json(const World& world, const RecordingSize& size) {
  return {{"schema", "vpr.world-info/1"},
          {"walks", world.walks.size()},
          {"frames", size.frames},
          {"places", world.places.size()},
          {"views", size.views}};
}

}  // namespace vpr
