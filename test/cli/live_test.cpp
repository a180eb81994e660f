// vpr-query live, and the filter over places and rates.
#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "npz.h"
#include "query/live_lines.h"
#include "world.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

const std::string kLive = "vpr-query live $db --query ";

// The frames of a sequence as a list, which has an end.
std::string list_of(const fs::path& walk, const fs::path& list, const std::string& more = "") {
  std::string text;
  for (const std::string& name : images_of(walk)) text += (walk / name).string() + "\n";
  write_text(list, text + more);
  return list.string();
}

// What vpr-query live says at a frame, but for recognitions of other frames by the filter.
std::optional<LiveAnswer> answer_at(const Result& result, size_t frame) {
  const size_t length = result.window_length();
  if (frame + 1 < length) return std::nullopt;
  const size_t window = frame + 1 - length;
  if (!result.best[window]) return std::nullopt;
  LiveAnswer answer{result.best[window], frame_margin(result, window), std::nullopt, {}};
  if (result.path) answer.rate = result.path->rates[window];
  for (const Match& match : result.recognitions)
    if (result.path || match.query == window) answer.recognized.push_back(match);
  return answer;
}

// The results of the whole query in the format of vpr-query live.
Words offline_lines(const std::string& query, const std::string& words, const Words& names) {
  run_ok("vpr-query $db --query " + query + " " + words + " -o r.json --force --quiet");
  const Result result = read_result("r.json").result;
  REQUIRE(result.query.frames == names.size());
  Words lines;
  for (size_t frame = 0; frame < names.size(); ++frame) {
    const auto& gaps = result.query.unreadable;
    const bool is_gap = std::find(gaps.begin(), gaps.end(), frame) != gaps.end();
    lines.push_back(
        to_line(live_line({frame, names[frame], !is_gap}, result, answer_at(result, frame))));
  }
  return lines;
}

RunOutcome query_live(const std::string& words, const std::string& environment = "") {
  return run("vpr-query $db --method filter --query " + words, environment);
}

}  // namespace

TEST_CASE("a recording followed to its end has the results of the whole query, byte for byte") {
  const fs::path walk = world().walk("back");
  const std::string list =
      list_of(walk, "list.txt", "off_map.png\n" + (walk / "00003.png").string() + "\n");
  Words names = images_of(walk);
  names.insert(names.end(), {"off_map.png", "00003.png"});
  for (const std::string words :
       {"--c-l 10", "--c-l 10 --method fastable-online --decide margin",
        "--c-l 5 --t-r 150 --t-r-scale bits", "--c-l 5 --score zscore --t-r -1.5",
        "--c-l 5 --score zscore --margin 0.5 --decide margin --threads 3"}) {
    INFO(words);
    const std::string all = words + " --skip-unreadable";
    const auto expected = offline_lines(list, all, names);
    const auto live = run_ok("vpr-query live $db --query " + list + " " + all);
    CHECK(lines_of(live.out) == expected);
    CHECK(has(live.out, "\"recognized\":[{"));
    CHECK(has(live.err, "from frame to line"));
  }
}

TEST_CASE("a video is followed to its end") {
  Words names;
  {
    cv::VideoWriter writer("walk.avi", cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10, {160, 120});
    REQUIRE(writer.isOpened());
    for (int i = 0; i < 12; ++i) {
      writer.write(cv::imread(fmt::format("{}/{:05}.png", world().walk("back"), i)));
      if (i >= 2) names.push_back(fmt::format("#{}", i));
    }
  }
  const std::string words = "--c-l 3 --score zscore --decide margin";
  const auto expected = offline_lines("walk.avi@2:12", words, names);
  const auto live = run_ok(kLive + "walk.avi@2:12 " + words);
  CHECK(lines_of(live.out) == expected);
}

TEST_CASE(
    "what cannot be followed is not listed in the help, and an unreadable frame ends a live "
    "query") {
  const std::string help = run_ok("vpr-query live --help").out;
  for (const std::string word : {"openable", "lsh", "relative", "--output"})
    CHECK_FALSE(has(help, word));
  const std::string list = list_of(world().walk("back"), "list.txt", "off_map.png\n");
  const auto unreadable = run(kLive + list + " --quiet");
  CHECK(unreadable.exit_code == 3);
  CHECK(lines_of(unreadable.out).size() + 1 == lines_of(read_text(list)).size());
}

TEST_CASE("--method filter alone recognizes a route at its speed and at double speed") {
  const std::string back = world().walk("back");
  for (const std::string range : {"", "@::2"}) {
    INFO(range);
    const std::string path = "r" + std::to_string(range.size()) + ".json";
    const Json json = printed_json(query_live(back + range + " -o " + path + " --json"));
    CHECK(json["settings"]["margin"] == 14);
    CHECK(json["totals"]["recognitions"] > 0);
    CHECK(json["files"]["path"]["rows"] == json["query"]["frames"]);
    CHECK(json["clusters"].size() == 1);  // one path at any rate
    if (!range.empty()) continue;
    const Json report = printed_json("vpr-eval " + path + " --ground-truth $truth --json");
    CHECK(report["counts"]["pairs"]["correct"] == json["totals"]["recognitions"]);
    CHECK(report["counts"]["pairs"]["incorrect"] == 0);
    CHECK(report["confidence"] == "margin");
    CHECK(report["protocol"]["pairs"] ==
          "best matches with a path score better than the runner-up by at least the margin");
    // The last frame's rate: both sequences have the same speed.
    const auto values = npz_array<double>("r0.npz", "path");
    CHECK(values[values.size() - 3] == Approx(1).epsilon(0.3));
    // The result's settings reproduce it, also with other threads and another SIMD target.
    const auto again = query_live(back + " --config " + path + " --threads 3 --json",
                                  "VPR_SIMD=" + simd_targets().back());
    CHECK(printed_json(again)["clusters"] == json["clusters"]);
  }
}
