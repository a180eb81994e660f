// vpr-query live, and the filter over places and rates.
#include <csignal>
#include <fstream>

#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "files/result_file.h"
#include "running.h"
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

// The results of the whole query in the format of vpr-query live.
Words offline_lines(const std::string& query, const std::string& words, const Words& names,
                    const std::string& database = "$db") {
  run_ok("vpr-query " + database + " --query " + query + " " + words +
         " -o r.json --force --quiet");
  const Result result = read_result("r.json").result;
  REQUIRE(result.query.frames == names.size());
  const size_t length = result.window_length();
  Words lines;
  for (size_t frame = 0; frame < names.size(); ++frame) {
    const auto& gaps = result.query.unreadable;
    const bool is_gap = std::find(gaps.begin(), gaps.end(), frame) != gaps.end();
    const bool has_window = frame + 1 >= length && result.best[frame + 1 - length];
    lines.push_back(to_line(live_line({frame, names[frame], !is_gap},
                                      has_window ? &result : nullptr, frame + 1 - length)));
  }
  return lines;
}

RunOutcome query(const std::string& words, const std::string& environment = "") {
  return run("vpr-query $db --method filter --query " + words, environment);
}

}  // namespace

TEST_CASE("a recording followed to its end has the results of the whole query, byte for byte") {
  const fs::path walk = world().walk("back");
  const std::string list =
      list_of(walk, "list.txt", "off_map.png\n" + (walk / "00003.png").string() + "\n");
  Words names = images_of(walk);
  names.insert(names.end(), {"off_map.png", "00003.png"});
  run_ok("vpr-train fastable --train $one --c-l 10 -o one.vprdb");
  for (const std::string words :
       {"--c-l 10", "--c-l 10 --method fastable-online --decide margin",
        "--c-l 5 --t-r 150 --t-r-scale bits", "--c-l 5 --score zscore --t-r -1.5",
        "--c-l 5 --score zscore --margin 0.5 --decide margin --threads 3",
        "--c-l 10 --decide margin --fuse $fabmap"}) {
    INFO(words);
    const std::string database = has(words, "--fuse") ? "one.vprdb" : "$db";
    const std::string all = words + " --skip-unreadable";
    const auto expected = offline_lines(list, all, names, database);
    const auto live = run_ok("vpr-query live " + database + " --query " + list + " " + all);
    CHECK(lines_of(live.out) == expected);
    CHECK(has(live.out, "\"recognized\":[{"));
    CHECK(has(live.err, "from frame to line"));
  }
}

TEST_CASE("the filter decides the same frames of a recording as they arrive and as a whole") {
  const std::string walk = world().walk("back");
  ok(query(walk + " -o r.json"));
  const StoredResult whole = read_result("r.json");
  const std::string list = list_of(walk, "list.txt", "");
  const Words lines = lines_of(run_ok(kLive + list + " --method filter").out);
  CHECK(lines.size() == whole.result.query.frames + 1);  // the last line is of the end
  std::vector<Match> decided;
  for (const std::string& text : lines) {
    const Json line = Json::parse(text);
    for (const Json& match : line["recognized"]) {
      decided.push_back({match["query"], 0, match["frame"], 0, match["sum"]});
      CHECK(whole.result.path->decided[decided.back().query] == line["frame"]);
    }
  }
  CHECK(decided == whole.result.recognitions);
  CHECK(decided.size() > 20);
}

TEST_CASE("a growing folder is followed until Ctrl-C") {
  const fs::path walk = world().walk("back");
  Words names = images_of(walk);
  names.resize(20);
  const std::string windows = "--c-l 3 --score zscore --decide margin";
  const auto expected = offline_lines(walk.string() + "@0:20", windows, names);
  fs::create_directory("frames");
  Running live(kLive + "frames " + windows);
  for (size_t frame = 0; frame < names.size(); ++frame) {
    const std::string picture = read_text(walk / names[frame]);
    if (frame % 2 == 0) {  // in two halves; or at once under another name
      std::ofstream file("frames/" + names[frame], std::ios::binary);
      file << picture.substr(0, picture.size() / 2) << std::flush;
      file << picture.substr(picture.size() / 2);
    } else {
      write_text("frames/.part", picture);
      fs::rename("frames/.part", "frames/" + names[frame]);
    }
    CHECK(live.line() == expected[frame]);
  }
  live.signal(SIGINT);
  const auto outcome = live.finish();
  CHECK(outcome.exit_code == 130);
  CHECK(outcome.out.empty());
  CHECK(has(outcome.err, "20 frames; from frame to line"));
}

TEST_CASE("image paths on standard input are followed to their end") {
  const fs::path walk = world().walk("back");
  Running live(kLive + "- --c-l 2 --t-r 300 --t-r-scale bits");
  for (const std::string name : {"00000.png", "00001.png"}) {
    // Some editors write a byte order mark at the beginning.
    live.write((name == "00000.png" ? "\xef\xbb\xbf" : "# a note\n\n") + (walk / name).string() +
               "\n");
    const Json line = Json::parse(live.line());
    CHECK(line["name"] == name);
    CHECK(line["match"].is_null() == (name == "00000.png"));
  }
  live.write((walk / "00002.png").string());  // without a line feed
  live.close_input();
  CHECK(Json::parse(live.line())["frame"] == 2);
  ok(live.finish());
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

TEST_CASE("inputs that cannot be followed are refused, and not listed in the help") {
  check_refused("vpr-query live $db --query $back",
                {{"--t-r 0.5", 2, "relative"},
                 {"--score zscore-offline", 2, "zscore-offline"},
                 {"--rates 1,2", 2, "rates"},
                 {"--method lsh", 2, "lsh"},
                 {"--decide margin --max-memory 100", 2, "--max-memory"},
                 {"--speed 2", 2, "--speed"},
                 {"--verify 3", 2, "--verify"},
                 {"-o r.json", 2, "not expected: r.json -o"},
                 {"--save-matrix m.npy", 2, "--save-matrix"}});
  const std::string help = run_ok("vpr-query live --help").out;
  for (const std::string word : {"openable", "lsh", "zscore-offline", "relative", "--output"})
    CHECK_FALSE(has(help, word));
  check_refused("vpr-query", {{"live $db --query $back@0:5", 2, "range"},
                              {"live $fabmap --query $back", 4, "vpr-query live"},
                              {"live $db --query-npy q.npy", 2, "--query-npy"},
                              {"live $db --query /dev/null", 3, "camera"},
                              {"$db --query /dev/null", 3, "vpr-query live"},
                              {"live $db --query /dev/video99", 3, "no such"}});
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
    const Json json = printed_json(query(back + range + " -o " + path + " --json"));
    CHECK(json["settings"]["method"] == "filter");
    CHECK(json["settings"]["c_l"] == 1);
    CHECK(json["settings"]["score"] == "zscore");
    CHECK(json["settings"]["decide"] == "margin");
    CHECK(json["settings"]["margin"] == 14);
    CHECK(json["settings"]["filter"]["path_keyframes"] == 16);
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
    const auto values = read_array<double>("r0.path.npy");
    CHECK(values[values.size() - 3] == Approx(1).epsilon(0.3));
    // The result's settings reproduce it, also with other threads and another SIMD target.
    const auto again = query(back + " --config " + path + " --threads 3 --json",
                             "VPR_SIMD=" + simd_targets().back());
    CHECK(printed_json(again)["clusters"] == json["clusters"]);
  }
}
