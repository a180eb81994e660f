#include "truth/dataset.h"

#include <catch2/catch.hpp>

#include "base/error.h"
#include "support.h"

using namespace vpr;

namespace {

Dataset parse(const std::string& text) {
  test::write_text("d.json", text);
  return read_dataset("d.json");
}

}  // namespace

TEST_CASE("paths in a data set description are relative to it") {
  const Dataset dataset = parse(R"({"schema": "vpr.dataset/3", "name": "d", "fps": 8,
    "pretrain": ["p"], "train": [{"name": "t", "sequence": "a/b@1:3"}],
    "places": [{"name": "hall", "sequences": ["h1", "h2"]}],
    "queries": [{"name": "q", "sequence": "/abs",
                 "ground_truth": {"format": "pairs", "path": "g.csv", "tolerance": 2}},
                {"name": "r", "sequence": "r", "place_ground_truth": {"format": "aligned"}}]})");
  CHECK(dataset.frames_per_second == 8);
  CHECK(dataset.train.at(0).sequence.path == "a/b");
  CHECK(dataset.train.at(0).sequence.range == FrameRange{1, 3, 1});
  CHECK(dataset.places.at(0).views.size() == 2);
  CHECK(dataset.queries.at(0).sequence.sequence.path == "/abs");
  CHECK(dataset.queries.at(0).sequence_ground_truth->path == "g.csv");
  CHECK(dataset.queries.at(0).sequence_ground_truth->tolerance_frames == 2);
  CHECK(dataset.queries.at(1).place_ground_truth->format == "aligned");
  CHECK(select_query(dataset, "r").sequence.name == "r");
  CHECK(test::has(test::error_text([&] { select_query(dataset, std::nullopt); }), "q, r"));
  CHECK(test::error_kind([&] { select_query(dataset, "x"); }) == ErrorKind::usage);
}

TEST_CASE("a ground truth has the options of its format") {
  const Dataset dataset = parse(R"({"schema": "vpr.dataset/3", "name": "d",
    "queries": [{"name": "q", "sequence": "q", "ground_truth": {"path": "p.csv", "reference": "r.csv",
                 "radius_m": 5, "angle_deg": 40, "matrix_rows": "reference", "soft": "s.npy",
                 "train_step": 2, "query_times": "t.txt", "train_pose_times": "p.txt",
                 "max_difference_s": 0.1, "train_offset_s": -3}}]})");
  const GroundTruthArgument& argument = *dataset.queries.at(0).sequence_ground_truth;
  CHECK(argument.format.empty());
  CHECK(argument.options.reference == "r.csv");
  CHECK(argument.options.soft == "s.npy");
  CHECK(argument.options.radius_m == 5);
  CHECK(argument.options.angle_deg == 40);
  CHECK(argument.options.train_step == 2);
  CHECK(argument.options.matrix_rows == MatrixRows::reference);
  CHECK(argument.options.query.times == "t.txt");
  CHECK(argument.options.train.pose_times == "p.txt");
  CHECK(argument.options.max_difference_s == 0.1);
  CHECK(argument.options.train.offset_s == -3);
}

TEST_CASE("errors in a data set description are usage errors") {
  const std::string text = GENERATE(
      R"([])", R"({"name": "d"})", R"({"schema": "vpr.dataset/3"})",
      R"({"schema": "vpr.dataset/3", "name": "d", "trian": []})",
      R"({"schema": "vpr.dataset/3", "name": "d", "train": [{"name": "t"}]})",
      R"({"schema": "vpr.dataset/3", "name": "d", "train": [{"name": "t", "sequence": "a"},
                                                            {"name": "t", "sequence": "b"}]})",
      R"({"schema": "vpr.dataset/3", "name": "d", "places": [{"name": "t", "sequences": []}]})",
      R"({"schema": "vpr.dataset/3", "name": "d",
          "queries": [{"name": "q", "sequence": "a", "ground_truth": {"tolerance": 1}}]})",
      R"({"schema": "vpr.dataset/3", "name": "d",
          "queries": [{"name": "q", "sequence": "a", "ground_truth": {"path": "g", "radius": 1}}]})",
      R"({"schema": "vpr.dataset/3", "name": "d", "plan": ""})",
      R"({"schema": "vpr.dataset/2", "name": "d"})", R"({"schema": )");
  CHECK(test::error_kind([&] { parse(text); }) == ErrorKind::usage);
}
