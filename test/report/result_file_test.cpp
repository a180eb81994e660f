#include "report/result_file.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/json.h"
#include "base/random.h"
#include "support.h"

using namespace vpr;
namespace fs = std::filesystem;

namespace {

Result example() {
  Result result;
  SequenceQuerySettings settings;
  settings.window_length = 2;
  settings.distance_threshold = 0.4;
  result.settings = settings;
  result.query_name = "walk";
  result.query_frames = 5;
  result.query_unreadable = {4};
  result.query_windows = 4;
  result.targets = {{"a", 6, 5, true, 0.4, ThresholdScale::relative, 12, 30},
                    {"b", 3, 2, false, {}, ThresholdScale::bits, 0, {}}};
  result.hits = {{0, 0, 1, 0, 11}, {1, 0, 2, 0, 9}};
  result.best = {Match{0, 0, 1, 0, 11}, Match{1, 0, 2, 0, 9}, Match{2, 0, 0, 0, 20}, std::nullopt};
  result.clusters = {{{0, 1, 0, 1, 2, 1, 2, 2, 9}}, {0, 0}};
  return result;
}

// Two places of three views, five frames, of which one shows no word and one is unreadable.
Result places_example() {
  Result result;
  result.settings = FabmapQuerySettings{};
  result.query_name = "walk";
  result.query_frames = result.query_windows = 5;
  result.query_unreadable = {4};
  result.targets = {{"places", 2, 2, true, {}, ThresholdScale::bits, 0, {}}};
  result.places = ResultPlaces{{"hall", "stairs"}, 3, 1, {0.1, 0.2, 0.3, 0.9, 0}};
  result.hits = {{0, 0, 0, 1, 0.995}, {0, 0, 1, 2, 0.991}, {2, 0, 1, 2, 0.999}};
  result.best = {result.hits[0], Match{1, 0, 0, 0, 0.25}, result.hits[2], std::nullopt,
                 std::nullopt};
  return result;
}

Json write(const fs::path& path, const Result& result, Existing existing) {
  OutputTransaction outputs(existing);
  Json json = write_result(path, result, {}, outputs);
  outputs.commit();
  return json;
}

fs::path write_example(const test::TemporaryFolder& folder, Existing existing = Existing::refuse) {
  write(folder / "r.json", example(), existing);
  return folder / "r.json";
}

}  // namespace

TEST_CASE("companions are named after the result") {
  CHECK(companion_path("a/r.json", "hits.npy") == "a/r.hits.npy");
  CHECK(companion_path("a/r", "hits.npy") == "a/r.hits.npy");
  CHECK(companion_path("a/r.v2.json", "best.npy") == "a/r.v2.best.npy");
}

TEST_CASE("a result that was written is read back") {
  const test::TemporaryFolder folder;
  const Result result = read_result(write_example(folder)).result;
  const Result expected = example();
  CHECK(settings_in_force(result.settings) == settings_in_force(expected.settings));
  CHECK(result.hits == expected.hits);
  CHECK(result.best == expected.best);
  CHECK(result.clusters->all == expected.clusters->all);
  CHECK(result.query_unreadable == expected.query_unreadable);
  CHECK(result.targets[0].max_distance == 30);
  CHECK_FALSE(result.targets[1].searched);
  CHECK(test::list_folder(folder.path()) ==
        std::vector<std::string>{"r.best.npy", "r.best_scores.npy", "r.hit_scores.npy",
                                 "r.hits.npy", "r.json"});
}

TEST_CASE("A replayed query keeps which frames it shows, and what does not fit is refused") {
  const test::TemporaryFolder folder;
  Result expected = example();
  expected.replay = Replay{"varying", 7, 9, {0, 0, 4, 8, 8}};
  const Json json = write(folder / "r.json", expected, Existing::refuse);
  CHECK(json["query"]["warp"] == Json{{"name", "varying"}, {"seed", 7}, {"frames", 9}});
  const Result result = read_result(folder / "r.json").result;
  REQUIRE(result.replay);
  CHECK(result.replay->warp == "varying");
  CHECK(result.replay->seed == 7);
  CHECK(result.replay->recorded_frames == 9);
  CHECK(result.replay->sources == expected.replay->sources);
  for (const Replay& broken :
       {Replay{"2", 1, 8, {0, 0, 4, 8, 8}}, Replay{"2", 1, 9, {0, 0, 4, 8}},
        Replay{"2", 1, 9, {0, 0, 4, 8, 8, 8}}, Replay{"2", 1, 51, {0, 0, 4, 8, 8}}}) {
    Result other = example();
    other.replay = broken;
    write(folder / "r.json", other, Existing::replace);
    CHECK(test::error_kind([&] { read_result(folder / "r.json"); }) == ErrorKind::data);
  }
}

TEST_CASE("margins are written beside the best matches, and missing ones are no number") {
  const test::TemporaryFolder folder;
  Result result = example();
  CHECK(read_result(write_example(folder)).result.margins.empty());
  result.margins = {3, 0, std::nullopt, std::nullopt};
  result.targets[0].margin = 1.5;
  write(folder / "r.json", result, Existing::replace);
  const NpyArray file(folder / "r.margins.npy");
  const auto values = file.values<double>(1);
  REQUIRE(values.size() == 4);
  CHECK(values[0] == 3);
  CHECK(std::isnan(values[3]));
  const Result read = read_result(folder / "r.json").result;
  CHECK(read.margins == result.margins);
  CHECK(read.targets[0].margin == 1.5);
  for (const std::vector<std::optional<double>>& wrong :
       std::vector<std::vector<std::optional<double>>>{
           {3, 0, {}}, {-1, 0, {}, {}}, {0.5, 0, {}, {}}, {1e10, 0, {}, {}}, {3, 0, {}, 1}}) {
    result.margins = wrong;
    write(folder / "r.json", result, Existing::replace);
    CHECK(test::error_kind([&] { read_result(folder / "r.json"); }) == ErrorKind::data);
  }
}

TEST_CASE("a result of places is written by the same writer, and read back by the same reader") {
  const test::TemporaryFolder folder;
  const Result expected = places_example();
  const Json json = write(folder / "r.json", expected, Existing::refuse);
  CHECK(json["targets"][0] ==
        Json{{"name", "places"}, {"frames", 2}, {"windows", 2}, {"searched", true}});
  CHECK(json["places"]["views"] == 3);
  CHECK_FALSE(json.contains("clusters"));
  const Result result = read_result(folder / "r.json").result;
  CHECK(settings_in_force(result.settings) == settings_in_force(expected.settings));
  CHECK(result.hits == expected.hits);
  CHECK(result.best == expected.best);
  CHECK_FALSE(result.clusters);
  CHECK(result.places->names == expected.places->names);
  CHECK(result.places->new_place == expected.places->new_place);
  CHECK(result.places->featureless == 1);
  const NpyArray hits(folder / "r.hits.npy");
  const auto values = hits.values<int32_t>(2);
  CHECK(std::vector<int32_t>(values.begin(), values.end()) ==
        std::vector<int32_t>{0, 0, 0, 1, 0, 0, 1, 2, 2, 0, 1, 2});
}

TEST_CASE("a result of places that was tampered with is refused") {
  const test::TemporaryFolder folder;
  for (const auto& change : std::vector<void (*)(Result&)>{
           [](Result& r) { r.places->names.pop_back(); }, [](Result& r) { r.places->views = 2; },
           [](Result& r) { r.targets.push_back(r.targets[0]); },
           [](Result& r) { r.places->new_place.pop_back(); }, [](Result& r) { r.best.pop_back(); },
           [](Result& r) { r.query_windows = 4; }, [](Result& r) { r.hits[1].train = 2; },
           [](Result& r) { r.hits[1] = r.hits[0]; },
           [](Result& r) { r.hits[2].score = std::nan(""); }}) {
    Result result = places_example();
    change(result);
    write(folder / "r.json", result, Existing::replace);
    CHECK(test::error_kind([&] { read_result(folder / "r.json"); }) == ErrorKind::data);
  }
}

TEST_CASE("standardized scores are written as they are, may be negative, and are read back") {
  const test::TemporaryFolder folder;
  Result scored = example();
  auto& settings = std::get<SequenceQuerySettings>(scored.settings);
  settings.score = Score::standardized;
  settings.distance_threshold = -1.5;
  settings.threshold_scale = ThresholdScale::mean_z;
  scored.targets[0] = {"a", 6, 5, true, -1.5, ThresholdScale::mean_z, 2 * 32768 - 3072, {}};
  scored.hits = {{0, 0, 1, 0, -4000}, {1, 0, 2, 0, -3073}};
  scored.best = {scored.hits[0], scored.hits[1], Match{2, 0, 0, 0, 17}, std::nullopt};
  scored.clusters->all[0].best_score = -4000;
  scored.statistics = UsedStatistics{{}, 300.5};
  write(folder / "r.json", scored, Existing::refuse);
  const NpyArray file(folder / "r.best.npy");
  const auto best = file.values<int32_t>(2);
  CHECK(std::vector<int32_t>(best.begin(), best.end()) ==
        std::vector<int32_t>{0, 0, 1, 1, 0, 2, 2, 0, 0, 3, -1, -1});
  const NpyArray score_file(folder / "r.best_scores.npy");
  const auto scores = score_file.values<double>(1);
  CHECK(std::vector<double>(scores.begin(), scores.begin() + 3) ==
        std::vector<double>{-4000, -3073, 17});
  CHECK(std::isnan(scores[3]));
  const Json json = read_result_json(folder / "r.json");
  CHECK(json["targets"][0]["limit"] == -3072);
  CHECK(json["clusters"][0]["best_score"] == -4000);
  CHECK(json["statistics"]["typical_distance"] == 300.5);
  CHECK(json["settings"]["t_r_scale"] == "mean-z");
  const Result result = read_result(folder / "r.json").result;
  CHECK(result.hits == scored.hits);
  CHECK(result.best == scored.best);
  CHECK(result.clusters->all == scored.clusters->all);
  CHECK(result.targets[0].distance_limit == scored.targets[0].distance_limit);
}

TEST_CASE("settings of raw distances do not tell of standardized scores") {
  const Json raw = settings_in_force(SequenceQuerySettings{});
  CHECK(raw["t_r_scale"] == "relative");
  for (const char* key : {"score", "safety_margin", "standardization"})
    CHECK_FALSE(raw.contains(key));
  SequenceQuerySettings settings;
  settings.score = Score::standardized_offline;
  CHECK(settings_in_force(settings)["score"] == "standardized-offline");
  CHECK(settings_in_force(settings)["t_r_scale"] == "mean-z");
}

TEST_CASE("companions of another run are refused") {
  const test::TemporaryFolder folder;
  const test::TemporaryFolder other;
  const fs::path path = write_example(folder);
  Result changed = example();
  changed.hits.pop_back();
  write(other / "r.json", changed, Existing::refuse);
  fs::copy_file(other / "r.hits.npy", folder / "r.hits.npy", fs::copy_options::overwrite_existing);
  CHECK(test::error_text([&] { read_result(path); }).find("was not written together") !=
        std::string::npos);
  fs::remove(folder / "r.hits.npy");
  CHECK(test::error_kind([&] { read_result(path); }) == ErrorKind::input);
}

TEST_CASE("results that were tampered with are refused, never a crash") {
  const test::TemporaryFolder folder;
  const fs::path path = write_example(folder);
  const Json whole = Json::parse(test::read_text(path));
  const auto broken = [&](const std::string& pointer, const Json& value) {
    Json json = whole;
    json[Json::json_pointer(pointer)] = value;
    json.erase("checksum");
    json["checksum"] = result_checksum(json);
    test::write_text(path, json.dump());
    return test::error_kind([&] { read_result(path); });
  };
  for (const auto& [pointer, value] :
       std::vector<std::pair<std::string, Json>>{{"/settings/c_l", 0},
                                                 {"/settings/c_l", 3},
                                                 {"/query/windows", 5},
                                                 {"/query/frames", -1},
                                                 {"/query/frames", 1e30},
                                                 {"/targets/0/frames", 2},
                                                 {"/targets/0/windows", 6},
                                                 {"/targets", 3},
                                                 {"/clusters/0/target", 2},
                                                 {"/clusters/0/train/last", 5},
                                                 {"/clusters/0/query/window", 4},
                                                 {"/files/hits/checksum", "xxh3:0"},
                                                 {"/files", Json::array()},
                                                 {"/settings/clustering/eps", 5000},
                                                 {"/settings/clustering/eps", 0},
                                                 {"/clusters", Json::array()},
                                                 {"/clusters/0/hits", 3},
                                                 {"/schema", "vpr.result/3"},
                                                 {"/query", Json()}}) {
    INFO(pointer);
    CHECK(broken(pointer, value) == ErrorKind::data);
  }
}

TEST_CASE("a result whose text was changed is refused, unless only machine and timing were") {
  const test::TemporaryFolder folder;
  const fs::path path = write_example(folder);
  Json json = Json::parse(test::read_text(path));
  json["machine"]["threads"] = 99;
  test::write_text(path, to_text(json));
  read_result(path);
  json["clusters"] = Json::array();
  test::write_text(path, to_text(json));
  CHECK(test::error_text([&] { read_result(path); }).find("checksum") != std::string::npos);
}

TEST_CASE("where views begin is written beside the result and read back") {
  const test::TemporaryFolder folder;
  Result result = example();
  result.views = ResultViews{{0, 3}, {{0, 1, 5}, {0}}};
  const Json json = write(folder / "r.json", result, Existing::refuse);
  CHECK(json["files"]["views"]["rows"] == 6);
  const auto views = read_result(folder / "r.json").result.views;
  REQUIRE(views);
  CHECK(views->query == result.views->query);
  CHECK(views->train == result.views->train);
  test::write_text(folder / "r.views.npy", test::read_text(folder / "r.best.npy"));
  CHECK(test::error_kind([&] { read_result(folder / "r.json"); }) == ErrorKind::data);
  // Frames that are out of range or order, and sequences without the first one.
  for (const ResultViews& bad : {ResultViews{{0, 5}, {{0}, {0}}}, ResultViews{{0, 0}, {{0}, {0}}},
                                 ResultViews{{1}, {{0}, {0}}}, ResultViews{{0}, {{0}, {}}},
                                 ResultViews{{0}, {{0}, {0}, {0}}}}) {
    result.views = bad;
    write(folder / "r.json", result, Existing::replace);
    CHECK(test::error_kind([&] { read_result(folder / "r.json"); }) == ErrorKind::data);
  }
}

TEST_CASE("a cluster says which frames its windows cover") {
  const Json place = result_json(example(), {})["clusters"][0]["query"];
  CHECK(place["first"] == 0);
  CHECK(place["first_frame"] == 0);
  CHECK(place["last"] == 1);
  CHECK(place["anchor"] == 2);
  CHECK(place["last_frame"] == 2);
}

TEST_CASE("random damage gives an error or a result, never a crash") {
  const test::TemporaryFolder folder;
  const fs::path path = write_example(folder);
  RandomEngine engine(1);
  for (const char* name :
       {"r.json", "r.hits.npy", "r.hit_scores.npy", "r.best.npy", "r.best_scores.npy"}) {
    const std::string whole = test::read_text(folder / name);
    for (int i = 0; i < 300; ++i) {
      std::string text = whole.substr(0, 1 + uniform_below(engine, whole.size()));
      text[uniform_below(engine, text.size())] = static_cast<char>(engine());
      test::write_text(folder / name, text);
      test::error_kind([&] { read_result(path); });
    }
    test::write_text(folder / name, whole);
  }
  CHECK(read_result(path).result.hits == example().hits);
}

TEST_CASE("an existing result is refused as a whole") {
  const test::TemporaryFolder folder;
  write_example(folder);
  fs::remove(folder / "r.json");
  OutputTransaction outputs(Existing::refuse);
  CHECK(test::error_kind([&] { claim_result(folder / "r.json", outputs); }) == ErrorKind::usage);
  write_example(folder, Existing::replace);
}
