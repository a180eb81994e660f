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

Words words_of(const std::string& query, Words more) {
  return joined({world().database(), "--query", query}, more);
}

Words live_words(const std::string& query, const Words& more) {
  return joined({"live"}, words_of(query, more));
}

// The frames of a sequence as a list, which has an end.
std::string list_of(const fs::path& walk, const fs::path& list, const std::string& more = "") {
  std::string text;
  for (const std::string& name : images_of(walk)) text += (walk / name).string() + "\n";
  write_text(list, text + more);
  return list.string();
}

// The results of the whole query in the format of vpr-query live.
Words offline_lines(const std::string& query, Words words, const Words& names) {
  const TemporaryFolder folder;
  run_ok("vpr-query", words_of(query, joined(words, {"-o", folder / "r.json", "--quiet"})));
  const Result result = read_result(folder / "r.json").result;
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

RunOutcome query(Words words, const Words& environment = {}) {
  return run_program("vpr-query",
                     joined({world().database(), "--method", "filter", "--query"}, words),
                     environment);
}

}  // namespace

TEST_CASE("a recording followed to its end has the results of the whole query, byte for byte") {
  const TemporaryFolder folder;
  const fs::path walk = world().walk("back");
  const std::string list =
      list_of(walk, folder / "list.txt", "off_map.png\n" + (walk / "00003.png").string() + "\n");
  Words names = images_of(walk);
  names.insert(names.end(), {"off_map.png", "00003.png"});
  for (const Words& words :
       std::vector<Words>{{"--c-l", "10"},
                          {"--c-l", "10", "--method", "fastable-online", "--decide", "margin"},
                          {"--c-l", "5", "--t-r", "150", "--t-r-scale", "bits"},
                          {"--c-l", "5", "--score", "zscore", "--t-r", "-1.5"},
                          {"--c-l", "5", "--score", "zscore", "--margin", "0.5", "--decide",
                           "margin", "--threads", "3"}}) {
    INFO(words.back());
    const Words all = joined(words, {"--skip-unreadable"});
    const auto expected = offline_lines(list, all, names);
    const auto live = run_ok("vpr-query", live_words(list, all));
    CHECK(lines_of(live.out) == expected);
    CHECK(has(live.out, "\"recognized\":[{"));
    CHECK(has(live.err, "from frame to line"));
  }
}

TEST_CASE("the filter decides the same frames of a recording as they arrive and as a whole") {
  const TemporaryFolder folder;
  const std::string walk = world().walk("back");
  ok(query({walk, "-o", folder / "r.json"}));
  const StoredResult whole = read_result(folder / "r.json");
  const std::string list = list_of(walk, folder / "list.txt", "");
  const Words lines = lines_of(run_ok("vpr-query", live_words(list, {"--method", "filter"})).out);
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
  const TemporaryFolder folder;
  const fs::path walk = world().walk("back");
  Words names = images_of(walk);
  names.resize(20);
  const Words windows = {"--c-l", "3", "--score", "zscore", "--decide", "margin"};
  const auto expected = offline_lines(walk.string() + "@0:20", windows, names);
  fs::create_directory(folder / "frames");
  Running live("vpr-query", live_words(folder / "frames", windows));
  for (size_t frame = 0; frame < names.size(); ++frame) {
    const std::string picture = read_text(walk / names[frame]);
    if (frame % 2 == 0) {  // in two halves; or at once under another name
      std::ofstream file(folder / ("frames/" + names[frame]), std::ios::binary);
      file << picture.substr(0, picture.size() / 2) << std::flush;
      file << picture.substr(picture.size() / 2);
    } else {
      write_text(folder / "frames/.part", picture);
      fs::rename(folder / "frames/.part", folder / ("frames/" + names[frame]));
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
  Running live("vpr-query", live_words("-", {"--c-l", "2", "--t-r", "300", "--t-r-scale", "bits"}));
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
  const TemporaryFolder folder;
  const std::string path = folder / "walk.avi";
  Words names;
  {
    cv::VideoWriter writer(path, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10, {160, 120});
    REQUIRE(writer.isOpened());
    for (int i = 0; i < 12; ++i) {
      writer.write(cv::imread(fmt::format("{}/{:05}.png", world().walk("back"), i)));
      if (i >= 2) names.push_back(fmt::format("#{}", i));
    }
  }
  const Words words = {"--c-l", "3", "--score", "zscore", "--decide", "margin"};
  const auto expected = offline_lines(path + "@2:12", words, names);
  const auto live = run_ok("vpr-query", live_words(path + "@2:12", words));
  CHECK(lines_of(live.out) == expected);
}

TEST_CASE("inputs that cannot be followed are refused, and not listed in the help") {
  const std::string back = world().walk("back");
  for (const auto& [words, named] : std::vector<std::pair<Words, std::string>>{
           {{"--t-r", "0.5"}, "relative"},
           {{"--score", "zscore-offline"}, "zscore-offline"},
           {{"--rates", "1,2"}, "rates"},
           {{"--method", "lsh"}, "lsh"},
           {{"--decide", "margin", "--max-memory", "100"}, "--max-memory"},
           {{"--speed", "2"}, "--speed"},
           {{"--verify", "3"}, "--verify"},
           {{"-o", "r.json"}, "not expected: r.json -o"},
           {{"--save-matrix", "m.npy"}, "--save-matrix"}}) {
    check_failure("vpr-query", live_words(back, words), 2, named);
  }
  const std::string help = run_ok("vpr-query", {"live", "--help"}).out;
  for (const char* word : {"openable", "lsh", "zscore-offline", "relative", "--output"})
    CHECK_FALSE(has(help, word));
  check_failure("vpr-query", live_words(back + "@0:5", {}), 2, "range");
  check_failure("vpr-query", {"live", world().fabmap(), "--query", back}, 4, "vpr-query live");
  check_failure("vpr-query", {"live", world().database(), "--query-npy", "q.npy"}, 2,
                "--query-npy");
  check_failure("vpr-query", live_words("/dev/null", {}), 3, "camera");
  check_failure("vpr-query", words_of("/dev/null", {}), 3, "vpr-query live");
  check_failure("vpr-query", live_words("/dev/video99", {}), 3, "no such");
  const TemporaryFolder folder;
  const std::string list = list_of(back, folder / "list.txt", "off_map.png\n");
  const auto unreadable = run_program("vpr-query", live_words(list, {"--quiet"}));
  CHECK(unreadable.exit_code == 3);
  CHECK(lines_of(unreadable.out).size() + 1 == lines_of(read_text(list)).size());
}

TEST_CASE("--method filter alone recognizes a route at its speed and at double speed") {
  const TemporaryFolder folder;
  const std::string back = world().walk("back");
  for (const std::string range : {"", "@::2"}) {
    INFO(range);
    const std::string path = folder / ("r" + std::to_string(range.size()) + ".json");
    const Json json = printed_json(query({back + range, "-o", path, "--json"}));
    CHECK(json["settings"]["method"] == "filter");
    CHECK(json["settings"]["c_l"] == 1);
    CHECK(json["settings"]["score"] == "zscore");
    CHECK(json["settings"]["decide"] == "margin");
    CHECK(json["settings"]["margin"] == 15);
    CHECK(json["settings"]["filter"]["path_keyframes"] == 16);
    CHECK(json["totals"]["recognitions"] > 0);
    CHECK(json["files"]["path"]["rows"] == json["query"]["frames"]);
    CHECK(json["clusters"].size() == 1);  // one path at any rate
    if (!range.empty()) continue;
    const Json report =
        printed_json("vpr-eval", {path, "--ground-truth", world().truth("back"), "--json"});
    CHECK(report["counts"]["pairs"]["correct"] == json["totals"]["recognitions"]);
    CHECK(report["counts"]["pairs"]["incorrect"] == 0);
    CHECK(report["confidence"] == "margin");
    CHECK(report["protocol"]["pairs"] ==
          "best matches with a path score better than the runner-up by at least the "
          "margin");
    // The last frame's rate: both sequences have the same speed.
    const auto values = read_array<double>(folder / "r0.path.npy");
    CHECK(values[values.size() - 3] == Approx(1).epsilon(0.3));
    // The result's settings reproduce it, also with other threads and another SIMD target.
    const auto again = query({back, "--config", path, "--threads", "3", "--json"},
                             {"VPR_SIMD=" + simd_targets().back()});
    CHECK(printed_json(again)["clusters"] == json["clusters"]);
  }
}

TEST_CASE("a query of one frame, and one with a gap, can be filtered") {
  const std::string back = world().walk("back");
  const Json one = printed_json(query({back + "@0:1", "--json"}));
  CHECK(one["totals"]["recognitions"] == 0);
  CHECK(one["query"]["windows"] == 1);
  const TemporaryFolder folder;
  write_text(folder / "list.txt", back + "/00000.png\nnowhere.png\n" + back + "/00001.png\n");
  ok(query({folder / "list.txt", "--skip-unreadable", "--json"}));
}

TEST_CASE("settings that contradict the filter are refused") {
  const std::string back = world().walk("back");
  for (const auto& [words, named] : std::vector<std::pair<Words, std::string>>{
           {{"--c-l", "5"}, "--c-l"},
           {{"--score", "raw"}, "--score raw"},
           {{"--decide", "threshold"}, "--decide"},
           {{"--exclusion-frames", "4"}, "filter.near_keyframes"},
           {{"--t-r", "-1"}, "--t-r"},
           {{"--verify", "3"}, "--verify does not go with --method filter"}}) {
    check_failure(query(joined({back}, words)), 2, named);
  }
  const TemporaryFolder folder;
  write_text(folder / "c.json", R"({"filter": {"keyframe_change": -2}})");
  check_failure(query({back, "--config", folder / "c.json"}), 2, "filter.keyframe_change");
}
