#include "synth/recording.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "base/output_file.h"
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
  fs::create_directory(folder);
  const Crowd crowd(studio.world, walk, scene.plan, recorded.poses, studio.cast.size());
  parallel_for(recorded.poses.size(), studio.monitor, [&](size_t i) {
    const CameraPose& pose = recorded.poses[i];
    const View view{scene, studio.cast, crowd.at(pose.time_s), pose, walk.conditions};
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
  fs::create_directory(folder);
  for (size_t i = 0; i < place.headings.size(); ++i) {
    const View view{scene, studio.cast, {}, view_pose(place, i), Conditions()};
    const cv::Mat picture =
        render(studio.camera, view,
               named_engine(studio.world.seed, fmt::format("view/{}/{}", place.name, i)));
    write_frame(studio.world, picture, folder / fmt::format("{}{}", i, extension(studio.world)));
    studio.counter.add();
  }
}

// One floor after the other, so that no more than one is painted and in memory.
void render_floor(const Studio& studio, size_t floor, const std::vector<RecordedWalk>& walks,
                  const fs::path& folder) {
  const World& world = studio.world;
  const std::string& name = world.floors[floor].name;
  const bool used =
      std::any_of(walks.begin(), walks.end(),
                  [&](const RecordedWalk& recorded) { return recorded.walk->floor == name; }) ||
      std::any_of(world.places.begin(), world.places.end(),
                  [&](const WorldPlace& place) { return place.floor == name; });
  if (!used) return;
  const Scene scene = make_scene(world, floor, studio.monitor);
  for (const RecordedWalk& recorded : walks)
    if (recorded.walk->floor == name)
      render_walk(studio, scene, recorded, folder / recorded.walk->name);
  for (const WorldPlace& place : world.places)
    if (place.floor == name) render_views(studio, scene, place, folder / "places" / place.name);
}

bool is_frame(const fs::path& path) {
  return path.extension() == ".jpg" || path.extension() == ".png";
}

bool holds_only(const fs::path& folder, const std::set<std::string>& others) {
  for (const auto& entry : fs::directory_iterator(folder))
    if (!is_frame(entry.path()) && !others.contains(entry.path().filename().string())) return false;
  return true;
}

}  // namespace

RecordingSize write_recording(const World& world, const fs::path& folder, const Monitor& monitor) {
  const std::vector<RecordedWalk> walks = record_walks(world);
  RecordingSize size;
  for (const RecordedWalk& recorded : walks) size.frames += recorded.poses.size();
  for (const WorldPlace& place : world.places) size.views += place.headings.size();
  StepCounter counter(monitor, "render", size.frames + size.views);
  const Studio studio{world, make_camera(world), make_cast(world.seed), monitor, counter};
  if (!world.places.empty()) fs::create_directory(folder / "places");
  for (size_t floor = 0; floor < world.floors.size(); ++floor)
    render_floor(studio, floor, walks, folder);
  for (const auto& [name, text] : recording_texts(world, walks)) write_part(folder / name, text);
  return size;
}

bool is_recording_folder(const fs::path& folder) {
  std::error_code error;
  for (const char* name : {"dataset.json", "plan.csv"})
    if (!fs::is_regular_file(folder / name, error)) return false;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_directory()) {
      if (name != "dataset.json" && name != "places.csv" && name != "plan.csv" &&
          !name.ends_with(".ground_truth.csv") && !name.ends_with(".places.csv"))
        return false;
    } else if (name == "places") {
      for (const auto& place : fs::directory_iterator(entry.path()))
        if (!place.is_directory() || !holds_only(place.path(), {})) return false;
    } else if (!fs::is_regular_file(entry.path() / "poses.csv", error) ||
               !holds_only(entry.path(), {"poses.csv"})) {
      return false;
    }
  }
  return true;
}

}  // namespace vpr
