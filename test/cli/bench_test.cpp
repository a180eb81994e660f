// vpr-bench on small inputs.
#include <catch2/catch.hpp>

#include "cli/world.h"

using namespace vpr;
using namespace vpr::test;

namespace {

const std::string kSmall =
    "vpr-bench matching --databases 200,400 --c-l 5,10 --query-frames 30 --seconds 0.001 ";

}  // namespace

TEST_CASE("a benchmark writes JSON, tables and plots") {
  const auto outcome = run_ok(kSmall + "-o b.json --plot plots");
  CHECK(has(outcome.out, "fastable-online"));
  const Json json = file_json("b.json");
  CHECK(json["machine"]["threads"] == 1);
  CHECK(json["rows"].size() == 4 * 4 + 1);
  Words plots = {".vpr-files"};
  for (const std::string name :
       {"fastable-cpu", "openable-fps", "speed-up", "time-by-c_l", "time-by-frames"})
    for (const std::string kind : {".pdf", ".png", ".svg"}) plots.push_back(name + kind);
  CHECK(list_folder("plots") == plots);
  CHECK(has(read_text("plots/speed-up.svg"), ">times faster</text>"));
  const auto csv = run(kSmall + "--format csv");
  CHECK(csv.out.starts_with("work,frames,c_l,query_frames,recognitions,per,median,"));
  CHECK(run(kSmall + "-o b.json").exit_code == 2);
}

TEST_CASE("training is timed by database size, with its growth") {
  const Json json =
      printed_json("vpr-bench training --databases 200,400 --descriptor-length 30 --json");
  REQUIRE(json["rows"].size() == 2);
  CHECK(json["rows"][0]["values"]["processor_ms"] > 0);
  CHECK_FALSE(json["rows"][0]["values"].contains("exponent"));
  CHECK(json["rows"][1]["values"].contains("exponent"));
}

TEST_CASE("features of a frame count in frames per second, and images may be given") {
  const Json fabmap = printed_json(
      "vpr-bench fabmap --place-counts 10 --words 30 --words-per-frame 9 --count 0 --frame-ms 500 "
      "--variants fabmap2 --seconds 0.001 --json");
  CHECK(fabmap["rows"][1]["values"]["fps"].get<double>() == Approx(2).margin(0.1));
  write_walk("walk", 3, 0);
  const Json describe =
      printed_json("vpr-bench describe --images walk --features orb --seconds 0.001 --json");
  CHECK(describe["rows"].back()["parameters"]["files"] == 3);
}

TEST_CASE("a comparison exits with 5 if the new run is slower") {
  run_ok(kSmall + "-o a.json --quiet");
  Json json = file_json("a.json");
  for (Json& row : json["rows"]) {
    row["median_ms"] = 3 * row["median_ms"].get<double>();
    row["lower_quartile_ms"] = 2 * row["upper_quartile_ms"].get<double>();
  }
  write_text("b.json", json.dump());
  const auto compare = [&](const std::string& a, const std::string& b) {
    return run("vpr-bench compare " + a + " " + b);
  };
  ok(compare("a.json", "a.json"));
  const auto slower = compare("a.json", "b.json");
  CHECK(slower.exit_code == 5);
  CHECK(has(slower.out, "3.000"));
  ok(compare("b.json", "a.json"));
  CHECK(compare("a.json", "none.json").exit_code == 3);
  write_text("b.json", "{");
  CHECK(compare("a.json", "b.json").exit_code == 4);
}

TEST_CASE("a recording is played at its rate") {
  write_walk("walk", 12, 0);
  run_ok("vpr-train fastable --train walk --c-l 3 -o w.vprdb --quiet");
  const auto replayed = [&](const std::string& more) {
    return run("vpr-bench realtime w.vprdb --query walk --rate 100 --json " + more);
  };
  for (const auto& more : Words{"--c-l 3", "--c-l 3 --score zscore", "--method filter"}) {
    const Json row = printed_json(replayed(more))["rows"][0];
    CHECK(row["repetitions"] == 12);
    CHECK(row["values"]["latency_50_ms"].get<double>() <=
          row["values"]["latency_max_ms"].get<double>());
  }
}
