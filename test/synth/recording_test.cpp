#include "synth/recording.h"

#include <algorithm>
#include <bit>
#include <map>

#include <catch2/catch.hpp>
#include <opencv2/imgproc.hpp>

#include "base/json.h"
#include "base/statistics.h"
#include "cli/building.h"
#include "database/whole_frame.h"
#include "fabmap/local_features.h"
#include "support.h"
#include "synth/scene.h"
#include "truth/ground_truth.h"

using namespace vpr;
using namespace vpr::test;

namespace {

World small() { return read_world(source_path("configs/worlds/small.json")); }

std::map<std::string, std::string> texts_of(const World& world) {
  std::map<std::string, std::string> texts;
  for (auto& [name, text] : recording_texts(world, record_walks(world))) texts[name] = text;
  return texts;
}

// A training walk and a query, each of three frames at about x 1, 5, 9.
World three_frames() {
  World world;
  Floor floor;
  floor.name = "f";
  floor.rooms = {{RoomKind::corridor, 0, 0, 20, 2}};
  world.floors = {floor};
  world.same_place_m = 0.5;
  world.ignore_m = 1;
  world.walks.resize(2);
  for (Walk& walk : world.walks) {
    walk.floor = "f";
    walk.shake = 0;
    walk.frames = 3;
    walk.path = {{1, 1}, {9, 1}};
  }
  world.walks[0].name = "train";
  world.walks[1].name = "query";
  world.walks[1].use = WalkUse::query;
  world.places = {{"p", "f", 1, 1, {0}}, {"behind", "f", 1, 1, {180}}};
  return world;
}

}  // namespace

TEST_CASE("ground truth is determined by poses: same, ignore, different") {
  World world = three_frames();
  const auto walks = record_walks(world);
  CHECK(walks[0].poses[1].position.x == Approx(5).margin(0.8));
  const auto texts = texts_of(world);
  const std::string& pairs = texts.at("query.ground_truth.csv");
  CHECK(pairs.find("query,sequence,reference,label\n0,train,0,same\n") == 0);
  CHECK_FALSE(has(pairs, "0,train,2"));
  CHECK(has(pairs, "2,train,2,same\n"));
  CHECK(texts.at("query.places.csv").find("query,reference,label\n0,0,same\n1,0,ignore\n") == 0);
  CHECK_FALSE(has(texts.at("query.places.csv"), ",1,"));  // opposite heading
}

TEST_CASE("walks on another floor or in another direction never show the same place") {
  World world = three_frames();
  std::swap(world.walks[1].path[0], world.walks[1].path[1]);
  CHECK(texts_of(world).at("query.ground_truth.csv") == "query,sequence,reference,label\n");
  world = three_frames();
  Floor other;
  other.name = "g";
  other.like = "f";
  world.floors.push_back(other);
  world.walks[1].floor = "g";
  CHECK(texts_of(world).at("query.ground_truth.csv") == "query,sequence,reference,label\n");
}

TEST_CASE("a folder with anything but a recording is recognized as another folder") {
  World world = three_frames();
  world.image_width = world.image_height = 32;
  write_recording(world, ".", Monitor());
  CHECK(is_recording_folder("."));
  for (const char* other : {"notes.txt", "query/notes.txt", "places/x.png", "places/p/poses.csv"}) {
    INFO(other);
    write_text(other, "");
    CHECK_FALSE(is_recording_folder("."));
    std::filesystem::remove(other);
    CHECK(is_recording_folder("."));
  }
  for (const char* required : {"dataset.json", "plan.csv", "query/poses.csv"}) {
    std::filesystem::remove(required);
    CHECK_FALSE(is_recording_folder("."));
    write_text(required, "");
  }
  std::filesystem::create_directory("query/more");
  CHECK_FALSE(is_recording_folder("."));
}

TEST_CASE("pretraining omits frames that show a place") {
  World world = three_frames();
  world.walks[0].use = WalkUse::pretrain;
  world.walks[0].frames = 20;
  const Json dataset = Json::parse(texts_of(world).at("dataset.json"));
  REQUIRE(dataset["pretrain"].size() == 1);
  const std::string range = dataset["pretrain"][0];
  CHECK(range.starts_with("train@"));
  CHECK(range.ends_with(":20"));
  CHECK(range != "train@0:20");
}

TEST_CASE("the shipped worlds have the paper's numbers of frames") {
  const std::map<std::string, std::map<std::string, uint64_t>> expected = {
      {"put-lc",
       {{"train-forward", 458},
        {"train-backward", 438},
        {"library", 410},
        {"test", 466},
        {"test-2", 448}}},
      {"put-mc",
       {{"second-floor", 274},
        {"short", 620},
        {"long", 996},
        {"people-short", 525},
        {"people-long", 864}}},
      {"put-mc-floor1", {{"query", 320}}}};
  for (const auto& [name, walks] : expected) {
    const World world = read_world(source_path("configs/worlds/" + name + ".json"));
    std::map<std::string, uint64_t> frames;
    uint64_t train = 0;
    for (const RecordedWalk& recorded : record_walks(world)) {
      frames[recorded.walk->name] = recorded.poses.size();
      if (recorded.walk->use == WalkUse::train) train += recorded.poses.size();
    }
    for (const auto& [walk, count] : walks) CHECK(frames[walk] == count);
    if (name == "put-mc") CHECK(train == 1256 + 274);
    if (name == "put-mc-floor1") CHECK(train == 2127);
  }
}

TEST_CASE("the shipped walks at other speeds have exact ground truth, and a detour has none") {
  const World world = read_world(source_path("configs/worlds/speeds.json"));
  const std::vector<RecordedWalk> walks = record_walks(world);
  std::map<std::string, size_t> frames;
  for (const RecordedWalk& recorded : walks) frames[recorded.walk->name] = recorded.poses.size();
  const auto share = [&](const char* walk) {
    return static_cast<double>(frames[walk]) / static_cast<double>(frames["same"]);
  };
  CHECK(share("slow") == Approx(2).margin(0.02));
  CHECK(share("fast") == Approx(1.2 / 2.2).margin(0.02));
  for (const auto& [name, text] : recording_texts(world, walks))
    if (name.ends_with(".csv")) write_text(name, text);
  // Percent of frames that show no place of the training walk.
  const auto unknown = [&](const std::string& walk) {
    const GroundTruthScope scope = {{"", frames[walk]}, {{"trained", frames["trained"]}}};
    const GroundTruth truth = read_ground_truth({"pairs", (walk + ".ground_truth.csv"), 0}, scope);
    size_t none = 0;
    for (size_t q = 0; q < scope.query.frames; ++q) none += truth.has_match(q) ? 0 : 1;
    return 100.0 * static_cast<double>(none) / static_cast<double>(scope.query.frames);
  };
  for (const char* walk : {"same", "slow", "fast", "varying", "carried"}) {
    INFO(walk);
    CHECK(unknown(walk) < 1);
  }
  CHECK(unknown("detour") > 15);
  CHECK(unknown("detour") < 40);
  CHECK(unknown("back") == 100);  // opposite direction
}

TEST_CASE("rendered corridors have the detail and the similarity of real ones") {
  const World world = small();
  const Scene scene = make_scene(world, 0, Monitor());
  const auto people = make_people(world.seed);
  const Walk& walk = *std::find_if(world.walks.begin(), world.walks.end(),
                                   [](const Walk& w) { return w.name == "corridor"; });
  const auto poses = walk_poses(world, walk, scene.plan);
  std::vector<double> features, neighbors;
  std::vector<LdbCode> codes;
  for (size_t i = 0; i < 40; ++i) {
    const cv::Mat picture =
        render(make_camera(world), {scene, people, {}, poses[i], walk.conditions, {}},
               named_engine(world.seed, std::to_string(i)));
    REQUIRE(picture.size() == cv::Size(640, 480));
    cv::Mat gray;
    cv::cvtColor(picture, gray, cv::COLOR_BGR2GRAY);
    codes.push_back(describe_ldb(gray));
    if (i % 8 == 0) features.push_back(find_features(gray, FeatureSettings()).rows);
  }
  for (size_t i = 1; i < codes.size(); ++i) {
    int bits = 0;
    for (size_t byte = 0; byte < kLdbBytes; ++byte)
      bits += std::popcount(static_cast<uint8_t>(codes[i][byte] ^ codes[i - 1][byte]));
    neighbors.push_back(bits);
  }
  CHECK(median(features) >= 150);
  CHECK(median(neighbors) >= 20);
  CHECK(median(neighbors) <= 150);
}

TEST_CASE("invalid worlds are refused with a reason") {
  const auto refused = [&](const std::string& place, const Json& change) {
    Json world = Json::parse(building(1, {"one", "back"}));
    world[Json::json_pointer(place)].merge_patch(change);
    write_text("w.json", world.dump());
    return error_kind([&] { record_walks(read_world("w.json")); }) == ErrorKind::usage;
  };
  CHECK_FALSE(refused("/seed", 1));
  CHECK(refused("/floors/0/rooms/0/x", 0.3));
  CHECK(refused("/floors/0/rooms", Json::array()));
  CHECK(refused("/floors/0/like", "off_map"));
  CHECK(refused("/walks/0/floor", "off_map"));
  CHECK(refused("/walks/0/path", Json::array()));
  CHECK(refused("/walks/0/path/0", {1, 2, 3}));
  CHECK(refused("/walks/0/path/1", {19, 1.25}));  // outside
  CHECK(refused("/walks/1/name", "one"));
  CHECK(refused("/walks/1/name", "../up"));
  CHECK(refused("/walks/1/name", "places"));
  CHECK(refused("/walks/0/name", std::string(300, 'a')));
  CHECK(refused("/image_width", 1000000));
  CHECK(refused("/walks/0/frames", 1000000));
  CHECK(refused("/walks/0/speed_m_s", 0));
  CHECK(refused("/walks/0", {{"frames", 9}, {"stops", Json::array({{{"at_m", 1}}})}}));
  CHECK(refused("/walks/0/paces",
                {{{"from_m", 2}, {"speed_m_s", 1}}, {{"from_m", 1}, {"speed_m_s", 2}}}));
  CHECK(refused("/walks/0/paces", Json::array({{{"from_m", 2}, {"speed_m_s", 0}}})));
  CHECK(refused("/walks/0/cuts", Json::array({{{"at_m", 900}, {"to_m", 0}}})));
  CHECK(refused("/floors/0/rooms/-", {{"x", 400}, {"y", 400}, {"width", 2}, {"depth", 2}}));
  CHECK(refused("/color", "red"));
  CHECK(refused("/variety/finishes", 1.5));
  CHECK(refused("/variety/window_light", -1));
  CHECK(refused("/variety/color", 1));
  CHECK(refused("/variety/line_m", 3));
  CHECK(refused("/lost_frames", 0.6));
  CHECK(refused("/floors/0/renovated", 1.5));
  CHECK(refused("/floors/0/rooms/0/lamp_spacing_m", 0.1));
  CHECK(refused("/walks/0/jolt_deg", 6));
  CHECK(refused("/walks/0/crossing", 1001));
  CHECK(refused("/walks/0/conditions/shutter_s", 2));
  CHECK(refused(
      "/places",
      Json::array({{{"name", "p"}, {"floor", "ground"}, {"x", 5}, {"y", 4}, {"headings", {0}}}})));
}
