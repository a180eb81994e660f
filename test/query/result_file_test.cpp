#include "query/result_file.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "npz.h"
#include "query/result_examples.h"

using namespace vpr;
using namespace vpr::test;

TEST_CASE("arrays are named after the result") {
  CHECK(array_path("a/r.json") == "a/r.npz");
  CHECK(array_path("a/r") == "a/r.npz");
  CHECK(array_path("a/r.v2.json") == "a/r.v2.npz");
  Outputs outputs(Existing::refuse);
  CHECK(error_kind([&] { claim_result("r.npz", outputs); }) == ErrorKind::usage);
}

TEST_CASE("a result can be read back after writing") {
  const Result result = read_result(write_example()).result;
  const Result expected = example_result();
  CHECK(settings_in_force(result.settings) == settings_in_force(expected.settings));
  CHECK(result.recognitions == expected.recognitions);
  CHECK(result.best == expected.best);
  CHECK(result.clusters->all == expected.clusters->all);
  CHECK(result.query.unreadable == expected.query.unreadable);
  CHECK(result.sequences[0].max_distance == 30);
  CHECK_FALSE(result.sequences[1].searched);
  CHECK(test::list_folder(".") == std::vector<std::string>{"r.json", "r.npz"});
  CHECK(ZipFile("r.npz").names() == std::vector<std::string>{"recognitions.npy",
                                                             "recognition_scores.npy", "best.npy",
                                                             "best_scores.npy"});
  CHECK(has(error_text([] { read_result("r.npz"); }), "Pass its .json file"));
}

TEST_CASE("a resampled query stores its selection, and an invalid one is refused") {
  Result expected = example_result();
  expected.query.selection = Selection{"varying", 7, 9, {0, 0, 4, 8, 8}};
  const Json json = write("r.json", expected, Existing::refuse);
  CHECK(json["query"]["speed"] == Json{{"name", "varying"}, {"seed", 7}, {"frames", 9}});
  const Result result = read_result("r.json").result;
  REQUIRE_FALSE(result.query.selection.is_all());
  CHECK(result.query.selection.speed == "varying");
  CHECK(result.query.selection.seed == 7);
  CHECK(result.query.selection.recorded_frames == 9);
  CHECK(result.query.selection.sources == expected.query.selection.sources);
  for (const Selection& broken :
       {Selection{"2", 1, 8, {0, 0, 4, 8, 8}}, Selection{"2", 1, 9, {0, 0, 4, 8}},
        Selection{"2", 1, 9, {0, 0, 4, 8, 8, 8}}, Selection{"2", 1, 51, {0, 0, 4, 8, 8}}}) {
    Result other = example_result();
    other.query.selection = broken;
    write("r.json", other, Existing::replace);
    CHECK(test::error_kind([&] { read_result("r.json"); }) == ErrorKind::data);
  }
}

TEST_CASE("margins are written next to the best matches, and missing ones are NaN") {
  Result result = example_result();
  CHECK(read_result(write_example()).result.margins.empty());
  result.margins = {3, 0, std::nullopt, std::nullopt};
  result.sequences[0].margin = 1.5;
  write("r.json", result, Existing::replace);
  const auto values = npz_array<double>("r.npz", "margins");
  REQUIRE(values.size() == 4);
  CHECK(values[0] == 3);
  CHECK(std::isnan(values[3]));
  const Result read = read_result("r.json").result;
  CHECK(read.margins == result.margins);
  CHECK(read.sequences[0].margin == 1.5);
  for (const std::vector<std::optional<double>>& wrong :
       std::vector<std::vector<std::optional<double>>>{
           {3, 0, {}}, {-1, 0, {}, {}}, {0.5, 0, {}, {}}, {1e10, 0, {}, {}}, {3, 0, {}, 1}}) {
    result.margins = wrong;
    write("r.json", result, Existing::replace);
    CHECK(test::error_kind([&] { read_result("r.json"); }) == ErrorKind::data);
  }
}

TEST_CASE("the filter's path is read back, and every recognition needs a frame of decision") {
  Result result = example_result();
  result.path.emplace(5);
  result.path->numbers = {1, 1, 1, 1, 0};
  result.path->rates = {{}, 1, 1.5, 2, {}};
  result.path->decided = {{}, 3, 4, {}, {}};  // recognitions end at frames 1 and 2
  result.path->reversed_frames = 2;
  result.path->keyframes = 4;
  cluster(result);
  write("r.json", result, Existing::refuse);
  const ResultPath read = read_result("r.json").result.path.value();
  CHECK(read.rates == result.path->rates);
  CHECK(read.numbers == result.path->numbers);
  CHECK(read.decided == result.path->decided);
  CHECK(read.reversed_frames == 2);
  CHECK(read.keyframes == 4);
  result.path->keyframes = 6;
  write("r.json", result, Existing::replace);
  CHECK(test::error_kind([&] { read_result("r.json"); }) == ErrorKind::data);
  result.path->keyframes = 4;
  for (const std::optional<uint32_t> wrong : {std::optional<uint32_t>{}, {1}, {5}, {6}}) {
    result.path->decided[2] = wrong;
    write("r.json", result, Existing::replace);
    CHECK(test::error_kind([&] { read_result("r.json"); }) == ErrorKind::data);
  }
}

TEST_CASE("a result of places uses the same writer and reader") {
  const Result expected = places_example();
  const Json json = write("r.json", expected, Existing::refuse);
  CHECK(json["sequences"][0] ==
        Json{{"name", "places"}, {"frames", 2}, {"windows", 2}, {"searched", true}});
  CHECK(json["places"]["views"] == 3);
  CHECK_FALSE(json.contains("clusters"));
  const Result result = read_result("r.json").result;
  CHECK(settings_in_force(result.settings) == settings_in_force(expected.settings));
  CHECK(result.recognitions == expected.recognitions);
  CHECK(result.best == expected.best);
  CHECK_FALSE(result.clusters);
  CHECK(result.places->names == expected.places->names);
  CHECK(result.places->new_place == expected.places->new_place);
  CHECK(result.places->featureless == 1);
  CHECK(npz_array<int32_t>("r.npz", "recognitions") ==
        std::vector<int32_t>{0, 0, 0, 1, 0, 0, 1, 2, 2, 0, 1, 2});
}

TEST_CASE("z-scores are written exactly, may be negative, and are read back") {
  Result scored = example_result();
  scored.settings =
      SequenceQuerySettings{Threshold{{.window_length = 2, .score = Score::zscore}, -1.5}};
  scored.sequences[0] = {{"a", 6}, 5, true, -1.5, ThresholdScale::mean_z, 2 * 32768 - 3072, {}};
  scored.recognitions = {{0, 0, 1, 0, -4000}, {1, 0, 2, 0, -3073}};
  scored.best = {scored.recognitions[0], scored.recognitions[1], Match{2, 0, 0, 0, 17},
                 std::nullopt};
  scored.clusters->all[0].best_score = -4000;
  scored.statistics = UsedStatistics{{}, 300.5};
  write("r.json", scored, Existing::refuse);
  CHECK(npz_array<int32_t>("r.npz", "best") ==
        std::vector<int32_t>{0, 0, 1, 1, 0, 2, 2, 0, 0, 3, -1, -1});
  const auto scores = npz_array<double>("r.npz", "best_scores");
  CHECK(std::vector<double>(scores.begin(), scores.begin() + 3) ==
        std::vector<double>{-4000, -3073, 17});
  CHECK(std::isnan(scores[3]));
  const Json json = read_result_json("r.json");
  CHECK(json["sequences"][0]["limit"] == -3072);
  CHECK(json["clusters"][0]["best_score"] == -4000);
  CHECK(json["statistics"]["typical_distance"] == 300.5);
  CHECK(json["settings"]["t_r_scale"] == "mean-z");
  const Result result = read_result("r.json").result;
  CHECK(result.recognitions == scored.recognitions);
  CHECK(result.best == scored.best);
  CHECK(result.clusters->all == scored.clusters->all);
  CHECK(result.sequences[0].distance_limit == scored.sequences[0].distance_limit);
}

TEST_CASE("settings in files have the default scale of their score") {
  const Json raw = settings_in_force(SequenceQuerySettings{});
  CHECK(raw["t_r_scale"] == "relative");
  CHECK(raw["score"] == "raw");
  const SequenceQuerySettings settings{Threshold{{.score = Score::zscore}}};
  CHECK(settings_in_force(settings)["score"] == "zscore");
  CHECK(settings_in_force(settings)["t_r_scale"] == "mean-z");
}

TEST_CASE("the first frames of keyframes are written with the result and read back") {
  Result result = example_result();
  result.keyframes = ResultKeyframes{{0, 3}, {{0, 1, 5}, {0}}};
  const Json json = write("r.json", result, Existing::refuse);
  CHECK(json["files"]["keyframes"]["rows"] == 6);
  const auto keyframes = read_result("r.json").result.keyframes;
  REQUIRE(keyframes);
  CHECK(keyframes->query == result.keyframes->query);
  CHECK(keyframes->train == result.keyframes->train);
  // Frames that are out of range or order, and sequences without the first one.
  for (const ResultKeyframes& bad :
       {ResultKeyframes{{0, 5}, {{0}, {0}}}, ResultKeyframes{{0, 0}, {{0}, {0}}},
        ResultKeyframes{{1}, {{0}, {0}}}, ResultKeyframes{{0}, {{0}, {}}},
        ResultKeyframes{{0}, {{0}, {0}, {0}}}}) {
    result.keyframes = bad;
    write("r.json", result, Existing::replace);
    CHECK(test::error_kind([&] { read_result("r.json"); }) == ErrorKind::data);
  }
}

TEST_CASE("everything about a run is read back") {
  ResultContext context;
  context.run.program = "vpr-query";
  context.run.seed = 7;
  context.run.paths = {{"query", "walk"}};
  context.run.images = {{"query", "xxh3:1"}};
  context.database_fingerprint = "xxh3:2";
  context.matrix = {4, 5, {{"a", 0}}};
  context.files["matrix"] = {4, "xxh3:4"};
  Result result = example_result();
  result.recall = SearchRecall{4, 3, 2, 1};
  result.statistics = UsedStatistics{{}, 300.5};
  {
    Outputs outputs(Existing::refuse);
    outputs.file("m.png").write("image");
    write_result("r.json", result, context, outputs);
    outputs.commit();
  }
  const StoredResult stored = read_result("r.json");
  const ResultContext& read = stored.context;
  CHECK(read.run.program == "vpr-query");
  CHECK(read.run.seed == 7);
  CHECK(read.run.paths == context.run.paths);
  CHECK(read.run.images == context.run.images);
  CHECK(read.database_fingerprint == "xxh3:2");
  CHECK(read.matrix->sequences.at(0).sequence == "a");
  CHECK(read.files.at("matrix") == FileEntry{4, "xxh3:4"});
  CHECK(read.files.at("best").rows == 4);
  CHECK(read.companions.size() == 1);
  CHECK(stored.result.recall->found_best == 3);
  CHECK(stored.result.statistics->typical_distance == 300.5);
}

TEST_CASE("a cluster lists the frames of its windows") {
  const Json place = result_json(example_result(), {})["clusters"][0]["query"];
  CHECK(place["first"] == 0);
  CHECK(place["first_frame"] == 0);
  CHECK(place["last"] == 1);
  CHECK(place["anchor"] == 2);
  CHECK(place["last_frame"] == 2);
}
