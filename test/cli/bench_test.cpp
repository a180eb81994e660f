// vpr-bench as a user runs it, with little to do.
#include <algorithm>

#include <catch2/catch.hpp>

#include "base/json.h"
#include "cli/world.h"
#include "support.h"

using namespace vpr;
using test::run_program;
namespace fs = std::filesystem;

namespace {

std::vector<std::string> small(std::vector<std::string> more) {
  std::vector<std::string> words = {"matching",       "--databases", "200,400",   "--c-l", "5,10",
                                    "--query-frames", "30",          "--seconds", "0.001"};
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

}  // namespace

TEST_CASE("a benchmark gives JSON, tables and plots") {
  const test::TemporaryFolder out;
  const auto outcome =
      run_program("vpr-bench", small({"-o", out / "b.json", "--plot", out / "plots"}));
  REQUIRE(outcome.exit_code == 0);
  CHECK(outcome.out.find("fastable-online") != std::string::npos);
  const Json json = Json::parse(test::read_text(out / "b.json"));
  CHECK(json["machine"]["threads"] == 1);
  CHECK(json["rows"].size() == 4 * 4 + 1);
  CHECK(test::list_folder(out / "plots") ==
        std::vector<std::string>{".vpr-files", "speed-up.png", "speed-up.svg", "time-by-c_l.png",
                                 "time-by-c_l.svg", "time-by-frames.png", "time-by-frames.svg"});
  CHECK(test::read_text(out / "plots/speed-up.svg").find(">times faster</text>") !=
        std::string::npos);
  const auto csv = run_program("vpr-bench", small({"--format", "csv"}));
  CHECK(csv.out.starts_with("work,frames,c_l,query_frames,hits,per,median,"));
  CHECK(run_program("vpr-bench", small({"-o", out / "b.json"})).exit_code == 2);
}

TEST_CASE("a comparison ends with 5 where the new run is slower") {
  const test::TemporaryFolder out;
  REQUIRE(run_program("vpr-bench", small({"-o", out / "a.json", "--quiet"})).exit_code == 0);
  Json json = Json::parse(test::read_text(out / "a.json"));
  for (Json& row : json["rows"]) {
    row["median_ms"] = 3 * row["median_ms"].get<double>();
    row["lower_quartile_ms"] = 2 * row["upper_quartile_ms"].get<double>();
  }
  test::write_text(out / "b.json", json.dump());
  const auto compare = [&](const std::string& a, const std::string& b) {
    return run_program("vpr-bench", {"compare", out / a, out / b});
  };
  CHECK(compare("a.json", "a.json").exit_code == 0);
  const auto slower = compare("a.json", "b.json");
  CHECK(slower.exit_code == 5);
  CHECK(slower.out.find("3.000") != std::string::npos);
  CHECK(compare("b.json", "a.json").exit_code == 0);
  CHECK(compare("a.json", "none.json").exit_code == 3);
  test::write_text(out / "b.json", "{");
  CHECK(compare("a.json", "b.json").exit_code == 4);
}

TEST_CASE("settings of benchmarks out of range") {
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"matching", "--methods", "slowable"},
           {"matching", "--databases", "0"},
           {"matching", "--seconds", "0"},
           {"matching", "--train", "x", "--query", "y", "--descriptor-length", "8"},
           {"matching", "--train", "x"},
           {"describe", "--features", "surff"},
           {"fabmap", "--variants", "fabmap3"},
           {"fabmap", "--places", "0"}}) {
    const auto outcome = run_program("vpr-bench", words);
    INFO(words[0] << " " << words[1] << ": " << outcome.err);
    CHECK(outcome.exit_code == 2);
    CHECK(std::count(outcome.err.begin(), outcome.err.end(), '\n') == 1);
    CHECK(outcome.out.empty());
  }
}

TEST_CASE("a recording is replayed at its rate") {
  const test::TemporaryFolder out;
  fs::create_directory(out / "walk");
  for (int i = 0; i < 12; ++i)
    test::write_image(out / "walk" / (std::to_string(i) + ".png"), static_cast<uint64_t>(i));
  REQUIRE(run_program("vpr-train", {"fastable", "--train", out / "walk", "--c-l", "3", "-o",
                                    out / "w.vprdb", "--quiet"})
              .exit_code == 0);
  const auto replayed = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"realtime", out / "w.vprdb", "--query", out / "walk",
                                      "--rate",   "100",           "--c-l",   "3",
                                      "--json"};
    words.insert(words.end(), more.begin(), more.end());
    return run_program("vpr-bench", words);
  };
  for (const auto& more : std::vector<std::vector<std::string>>{
           {"--method", "fastable"}, {"--score", "standardized"}, {"--method", "filter"}}) {
    const auto outcome = replayed(more);
    INFO(outcome.err);
    REQUIRE(outcome.exit_code == 0);
    const Json row = Json::parse(outcome.out)["rows"][0];
    CHECK(row["repetitions"] == 12);
    CHECK(row["values"]["latency_50_ms"].get<double>() <=
          row["values"]["latency_max_ms"].get<double>());
  }
  test::write_array(out / "q.npy", std::vector<float>(12, 1), {3, 4});
  test::check_failure(run_program("vpr-bench", {"realtime", out / "w.vprdb", "--query",
                                                out / "q.npy", "--c-l", "2"}),
                      2, "not a folder or list of images");
  REQUIRE(run_program("vpr-train", {"descriptors", "--npy", out / "q.npy", "--c-l", "2", "-o",
                                    out / "v.vprdb", "--quiet"})
              .exit_code == 0);
  test::check_failure(run_program("vpr-bench", {"realtime", out / "v.vprdb", "--query",
                                                out / "walk", "--c-l", "2"}),
                      4, "imported descriptors");
}
