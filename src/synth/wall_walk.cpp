#include "synth/wall_walk.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "base/json.h"
#include "base/output_file.h"
#include "base/parallel.h"
#include "base/random.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr int kPixelsPerMetre = 40;
constexpr int kFrameWidth = 160;
constexpr int kFrameHeight = 120;
constexpr std::string_view kNameLetters =
    "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_";
constexpr size_t kMostFrames = 100'000;

int between(RandomEngine& engine, int low, int high) {
  return low + static_cast<int>(uniform_below(engine, static_cast<uint64_t>(high - low)));
}

// A board with sheets of paper, each with lines of "text".
void paint_board(cv::Mat& wall, RandomEngine& engine, int x, int width) {
  const cv::Rect board(x, between(engine, 25, 35), width, between(engine, 30, 45));
  cv::rectangle(wall, board, between(engine, 60, 130), cv::FILLED);
  for (int sheet = 0; sheet < width / 12; ++sheet) {
    const cv::Rect paper(between(engine, board.x, board.x + std::max(1, board.width - 14)),
                         between(engine, board.y, board.y + board.height - 16), 12, 15);
    cv::rectangle(wall, paper, between(engine, 180, 250), cv::FILLED);
    for (int line = 2; line < 14; line += 3)
      cv::line(wall, {paper.x + 2, paper.y + line},
               {paper.x + between(engine, 5, 11), paper.y + line}, between(engine, 20, 110));
  }
}

void paint_door(cv::Mat& wall, RandomEngine& engine, int x) {
  const int grey = between(engine, 40, 160);
  cv::rectangle(wall, cv::Rect(x, 22, 38, 88), grey, cv::FILLED);
  cv::rectangle(wall, cv::Rect(x, 22, 38, 88), grey / 2, 2);
  cv::rectangle(wall, cv::Rect(x + 12, 35, 14, 8), between(engine, 170, 255), cv::FILLED);
  cv::circle(wall, {x + 33, 70}, 2, 20, cv::FILLED);
}

void paint_lockers(cv::Mat& wall, RandomEngine& engine, int x, int width) {
  for (int left = x; left < x + width; left += 13)
    cv::rectangle(wall, cv::Rect(left, 40, 12, 70), between(engine, 70, 200), cv::FILLED);
}

void check(bool ok, const std::string& where, std::string_view what) {
  if (!ok) throw Error(ErrorKind::usage, fmt::format("{}: {}", where, what));
}

void check_world(const World& world, const std::string& where) {
  check(world.corridors >= 1 && world.corridors <= 1000, where, "corridors must be 1 to 1000");
  check(world.corridor_length_m >= 5 && world.corridor_length_m <= 500, where,
        "corridor_length_m must be 5 to 500");
  check(world.frames_per_s > 0 && world.frames_per_s <= 1000, where,
        "frames_per_s must be above 0 and at most 1000");
  check(world.same_place_m >= 0, where, "same_place_m must not be negative");
  check(!world.walks.empty(), where, "walks must not be empty");
  std::set<std::string> names;
  for (const Walk& walk : world.walks) {
    const auto on_wall = [&](double m) { return m >= 0 && m <= world.corridor_length_m; };
    check(!walk.name.empty() && walk.name.find_first_not_of(kNameLetters) == std::string::npos,
          where, "a walk's name must be of letters, digits, - and _");
    check(names.insert(walk.name).second, where, "two walks have the same name");
    check(walk.brightness >= 0 && walk.brightness <= 100, where, "brightness must be 0 to 100");
    check(walk.corridor < world.corridors, where, "a walk's corridor does not exist");
    check(on_wall(walk.from_m) && on_wall(walk.to_m), where, "a walk leaves its corridor");
    check(walk.speed_m_s > 0.01 && walk.speed_m_s <= 100, where,
          "speed_m_s must be above 0.01 and at most 100");
    check(walk.noise >= 0 && walk.noise <= 255, where, "noise must be 0 to 255");
    check(walk_positions(world, walk).size() < kMostFrames, where, "a walk has too many frames");
  }
}

// A sum of twelve uniform numbers: near enough to a normal one, and the same everywhere.
double noise_value(RandomEngine& engine) {
  double sum = -6;
  for (int i = 0; i < 12; ++i) sum += uniform_unit(engine);
  return sum;
}

uint64_t frame_seed(const World& world, const Walk& walk, size_t index) {
  uint64_t seed = world.seed * 1'000'003 + index;
  for (const char c : walk.name) seed = seed * 131 + static_cast<uint8_t>(c);
  return seed;
}

void write_walk(const World& world, const Walk& walk, const fs::path& folder,
                const Monitor& monitor, StepCounter& counter) {
  fs::create_directory(folder);
  const cv::Mat wall = paint_wall(world, walk.corridor);
  const std::vector<double> positions = walk_positions(world, walk);
  parallel_for(positions.size(), monitor, [&](size_t i) {
    std::vector<uint8_t> png;
    cv::imencode(".png", render_frame(world, walk, wall, i, positions[i]), png);
    OutputFile file(folder / fmt::format("{:05}.png", i), Existing::refuse);
    file.write(std::as_bytes(std::span(png)));
    file.commit();
    counter.add();
  });
  std::string csv = "frame,position_m\n";
  for (size_t i = 0; i < positions.size(); ++i) csv += fmt::format("{},{:.3f}\n", i, positions[i]);
  write_file(folder / "positions.csv", csv, Existing::refuse);
}

// Frames of the same corridor at most same_place_m apart.
std::string ground_truth_csv(const World& world, const Walk& query) {
  std::string csv = "query,sequence,reference\n";
  const std::vector<double> own = walk_positions(world, query);
  std::vector<std::pair<std::string, std::vector<double>>> walks;
  for (const Walk& walk : world.walks)
    if (!walk.is_query && walk.corridor == query.corridor)
      walks.emplace_back(walk.name, walk_positions(world, walk));
  for (size_t q = 0; q < own.size(); ++q)
    for (const auto& [name, positions] : walks)
      for (size_t r = 0; r < positions.size(); ++r)
        if (std::abs(positions[r] - own[q]) <= world.same_place_m)
          csv += fmt::format("{},{},{}\n", q, name, r);
  return csv;
}

Json dataset_json(const World& world) {
  Json json = {{"schema", "vpr.dataset/1"}, {"name", world.name}, {"fps", world.frames_per_s}};
  json["train"] = Json::array();
  json["queries"] = Json::array();
  for (const Walk& walk : world.walks) {
    if (!walk.is_query) {
      json["train"].push_back({{"name", walk.name}, {"sequence", walk.name}});
      continue;
    }
    json["queries"].push_back(
        {{"name", walk.name},
         {"sequence", walk.name},
         {"ground_truth", {{"format", "pairs"}, {"path", walk.name + ".ground_truth.csv"}}}});
  }
  return json;
}

}  // namespace

World read_world(const fs::path& path) {
  const std::string where = path.string();
  Json json = read_json(path, ErrorKind::usage);
  require_schema(json, "world", where, ErrorKind::usage);
  json.erase("schema");
  World world;
  const auto walks = json.find("walks");
  check(walks != json.end() && walks->is_array(), where, "needs a list \"walks\"");
  for (const Json& item : *walks) value_from_json(item, world.walks.emplace_back(), where, "walks");
  json.erase("walks");
  value_from_json(json, world, where, "world");
  check_world(world, where);
  return world;
}

bool is_world_folder(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_regular_file(folder / "dataset.json", error)) return false;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!entry.is_directory()) {
      if (name != "dataset.json" && !name.ends_with(".ground_truth.csv")) return false;
      continue;
    }
    if (!fs::is_regular_file(entry.path() / "positions.csv", error)) return false;
    for (const auto& file : fs::directory_iterator(entry.path()))
      if (file.path().filename() != "positions.csv" && file.path().extension() != ".png")
        return false;
  }
  return true;
}

std::vector<double> walk_positions(const World& world, const Walk& walk) {
  std::vector<double> positions;
  const double length = std::abs(walk.to_m - walk.from_m);
  const double direction = walk.to_m < walk.from_m ? -1 : 1;
  const double step = walk.speed_m_s / world.frames_per_s;
  for (double way = 0; way <= length && positions.size() < kMostFrames;
       way += step * (1 + 0.05 * std::sin(2 * std::numbers::pi * way / 7)))
    positions.push_back(walk.from_m + direction * way);
  return positions;
}

cv::Mat paint_wall(const World& world, uint64_t corridor) {
  RandomEngine engine(world.seed * 7919 + corridor);
  const int width = static_cast<int>(world.corridor_length_m * kPixelsPerMetre) + 2 * kFrameWidth;
  cv::Mat wall(kFrameHeight, width, CV_8UC1, cv::Scalar(between(engine, 150, 210)));
  wall.rowRange(110, kFrameHeight).setTo(between(engine, 50, 100));
  for (int x = 0; x < width - 60;) {
    const int thing = between(engine, 0, 5);
    const int extent = between(engine, 40, 90);
    if (thing == 0 || thing == 1) paint_door(wall, engine, x);
    if (thing == 2) paint_board(wall, engine, x, extent);
    if (thing == 3) paint_lockers(wall, engine, x, extent);
    x += extent + between(engine, 5, 70);
  }
  for (int x = between(engine, 10, 60); x < width - 30; x += between(engine, 70, 120))
    cv::rectangle(wall, cv::Rect(x, 3, 26, 6), 255, cv::FILLED);
  return wall;
}

cv::Mat render_frame(const World& world, const Walk& walk, const cv::Mat& wall, size_t index,
                     double position_m) {
  RandomEngine engine(frame_seed(world, walk, index));
  const auto left = static_cast<int>(std::lround(position_m * kPixelsPerMetre)) + kFrameWidth / 2;
  const int sway = between(engine, -1, 2);
  cv::Mat frame;
  cv::copyMakeBorder(wall.colRange(left, left + kFrameWidth), frame, 2, 2, 0, 0,
                     cv::BORDER_REPLICATE);
  frame = frame.rowRange(2 + sway, 2 + sway + kFrameHeight).clone();
  for (int y = 0; y < frame.rows; ++y)
    for (int x = 0; x < frame.cols; ++x)
      frame.at<uint8_t>(y, x) = cv::saturate_cast<uint8_t>(std::floor(
          frame.at<uint8_t>(y, x) * walk.brightness + walk.noise * noise_value(engine) + 0.5));
  return frame;
}

void write_world(const World& world, const fs::path& folder, const Monitor& monitor) {
  size_t frames = 0;
  for (const Walk& walk : world.walks) frames += walk_positions(world, walk).size();
  StepCounter counter(monitor, "render", frames);
  for (const Walk& walk : world.walks) {
    write_walk(world, walk, folder / walk.name, monitor, counter);
    if (walk.is_query)
      write_file(folder / (walk.name + ".ground_truth.csv"), ground_truth_csv(world, walk),
                 Existing::refuse);
  }
  write_file(folder / "dataset.json", to_text(dataset_json(world)), Existing::refuse);
}

}  // namespace vpr
