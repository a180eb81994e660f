// vpr-query --follow: frames as they come.
#include <csignal>
#include <fstream>

#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>

#include "base/json.h"
#include "report/result_file.h"
#include "running.h"
#include "support.h"
#include "world.h"

using namespace vpr;
using test::run_program;
using test::Running;
using test::world;
namespace fs = std::filesystem;

namespace {

std::vector<std::string> words_of(const std::string& query, std::vector<std::string> more) {
  more.insert(more.begin(), {world().database(), "--query", query});
  return more;
}

// The frames of a walk as a list, which has an end.
std::string list_of(const fs::path& walk, const fs::path& list, const std::string& more = "") {
  std::string text;
  for (const std::string& name : test::list_folder(walk))
    if (name.ends_with(".png")) text += (walk / name).string() + "\n";
  test::write_text(list, text + more);
  return list.string();
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  for (size_t begin = 0, end = 0; (end = text.find('\n', begin)) != std::string::npos;
       begin = end + 1)
    lines.push_back(text.substr(begin, end - begin));
  return lines;
}

// What the whole query says, in the words of --follow.
std::vector<std::string> offline_lines(const std::string& query, std::vector<std::string> words,
                                       const std::vector<std::string>& names) {
  const test::TemporaryFolder folder;
  words.insert(words.end(), {"-o", folder / "r.json", "--quiet"});
  const auto outcome = run_program("vpr-query", words_of(query, words));
  INFO(outcome.err);
  REQUIRE(outcome.exit_code == 0);
  const Result result = read_result(folder / "r.json").result;
  REQUIRE(result.query_frames == names.size());
  const size_t length = result.window_length();
  std::vector<std::string> lines;
  for (size_t frame = 0; frame < names.size(); ++frame) {
    const auto& gaps = result.query_unreadable;
    const bool is_gap = std::find(gaps.begin(), gaps.end(), frame) != gaps.end();
    const bool has_window = frame + 1 >= length && result.best[frame + 1 - length];
    lines.push_back(to_line(live_line({frame, names[frame], !is_gap},
                                      has_window ? &result : nullptr, frame + 1 - length)));
  }
  return lines;
}

}  // namespace

TEST_CASE("a recording followed to its end says what the whole query says, byte for byte") {
  const test::TemporaryFolder folder;
  const fs::path walk = world().walk("back");
  const std::string list =
      list_of(walk, folder / "list.txt", "nowhere.png\n" + (walk / "00003.png").string() + "\n");
  std::vector<std::string> names;
  for (const std::string& name : test::list_folder(walk))
    if (name.ends_with(".png")) names.push_back(name);
  names.insert(names.end(), {"nowhere.png", "00003.png"});
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {"--c-l", "10"},
           {"--c-l", "10", "--method", "fastable-online", "--decide", "margin"},
           {"--c-l", "5", "--t-r", "150", "--t-r-scale", "bits"},
           {"--c-l", "5", "--score", "standardized", "--t-r", "-1.5"},
           {"--c-l", "5", "--score", "standardized", "--decide", "margin", "--threads", "3"},
           {"--method", "filter"}}) {
    INFO(words.back());
    std::vector<std::string> all = words;
    all.emplace_back("--skip-unreadable");
    const auto expected = offline_lines(list, all, names);
    all.emplace_back("--follow");
    const auto live = run_program("vpr-query", words_of(list, all));
    INFO(live.err);
    CHECK(live.exit_code == 0);
    CHECK(lines_of(live.out) == expected);
    CHECK(live.out.find("\"recognised\":true") != std::string::npos);
    CHECK(live.err.find("from frame to line") != std::string::npos);
  }
}

TEST_CASE("a folder is followed as it is filled, until Ctrl-C") {
  const test::TemporaryFolder folder;
  const fs::path walk = world().walk("back");
  std::vector<std::string> names;
  for (const std::string& name : test::list_folder(walk))
    if (name.ends_with(".png")) names.push_back(name);
  names.resize(20);
  const auto expected = offline_lines(walk.string() + "@0:20", {"--method", "filter"}, names);
  fs::create_directory(folder / "frames");
  Running live("vpr-query", words_of(folder / "frames", {"--method", "filter", "--follow"}));
  for (size_t frame = 0; frame < names.size(); ++frame) {
    const std::string picture = test::read_text(walk / names[frame]);
    if (frame % 2 == 0) {  // in two halves; in one, by another name
      std::ofstream file(folder / ("frames/" + names[frame]), std::ios::binary);
      file << picture.substr(0, picture.size() / 2) << std::flush;
      file << picture.substr(picture.size() / 2);
    } else {
      test::write_text(folder / "frames/.part", picture);
      fs::rename(folder / "frames/.part", folder / ("frames/" + names[frame]));
    }
    CHECK(live.line() == expected[frame]);
  }
  live.signal(SIGINT);
  const auto outcome = live.finish();
  CHECK(outcome.exit_code == 130);
  CHECK(outcome.out.empty());
  CHECK(outcome.err.find("20 frames; from frame to line") != std::string::npos);
}

TEST_CASE("image paths on standard input are followed to their end") {
  const fs::path walk = world().walk("back");
  Running live("vpr-query",
               words_of("-", {"--c-l", "2", "--follow", "--t-r", "300", "--t-r-scale", "bits"}));
  for (const std::string name : {"00000.png", "00001.png"}) {
    // Some editors begin a list with a byte order mark.
    live.write((name == "00000.png" ? "\xef\xbb\xbf" : "# a note\n\n") + (walk / name).string() +
               "\n");
    const Json line = Json::parse(live.line());
    CHECK(line["name"] == name);
    CHECK(line["match"].is_null() == (name == "00000.png"));
  }
  live.write((walk / "00002.png").string());  // without a line feed
  live.close_input();
  CHECK(Json::parse(live.line())["frame"] == 2);
  CHECK(live.finish().exit_code == 0);
}

TEST_CASE("a video is followed to its end") {
  const test::TemporaryFolder folder;
  const std::string path = folder / "walk.avi";
  std::vector<std::string> names;
  {
    cv::VideoWriter writer(path, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10, {160, 120});
    REQUIRE(writer.isOpened());
    for (int i = 0; i < 12; ++i) {
      writer.write(cv::imread(fmt::format("{}/{:05}.png", world().walk("back"), i)));
      if (i >= 2) names.push_back(fmt::format("#{}", i));
    }
  }
  const std::vector<std::string> words = {"--c-l",        "3",        "--score",
                                          "standardized", "--decide", "margin"};
  const auto expected = offline_lines(path + "@2:12", words, names);
  std::vector<std::string> all = words;
  all.emplace_back("--follow");
  const auto live = run_program("vpr-query", words_of(path + "@2:12", all));
  INFO(live.err);
  CHECK(live.exit_code == 0);
  CHECK(lines_of(live.out) == expected);
}

TEST_CASE("what can't be followed is refused with a sentence") {
  const std::string back = world().walk("back");
  for (const auto& [words, named] : std::vector<std::pair<std::vector<std::string>, std::string>>{
           {{"--t-r", "0.5"}, "relative"},
           {{"--score", "standardized-offline"}, "standardized-offline"},
           {{"--rates", "1,2"}, "rates"},
           {{"--method", "lsh"}, "lsh"},
           {{"--decide", "margin", "--max-memory", "100"}, "--max-memory"},
           {{"--warp", "2"}, "--warp"},
           {{"--verify", "3"}, "--verify"},
           {{"-o", "r.json"}, "--output"},
           {{"--save-matrix", "m.npy"}, "--save-matrix"}}) {
    std::vector<std::string> all = words;
    all.emplace_back("--follow");
    test::check_failure(run_program("vpr-query", words_of(back, all)), 2, named);
  }
  test::check_failure(run_program("vpr-query", words_of(back + "@0:5", {"--follow"})), 2, "range");
  test::check_failure(run_program("vpr-query", {world().fabmap(), "--query", back, "--follow"}), 2,
                      "--follow");
  test::check_failure(
      run_program("vpr-query", {world().database(), "--query-npy", "q.npy", "--follow"}), 2,
      "--query-npy");
  test::check_failure(run_program("vpr-query", words_of("/dev/null", {"--follow"})), 3, "camera");
  test::check_failure(run_program("vpr-query", words_of("/dev/null", {})), 3, "--follow");
  test::check_failure(run_program("vpr-query", words_of("/dev/video99", {"--follow"})), 3,
                      "no such");
  const test::TemporaryFolder folder;
  const std::string list = list_of(back, folder / "list.txt", "nowhere.png\n");
  const auto unreadable = run_program("vpr-query", words_of(list, {"--follow", "--quiet"}));
  CHECK(unreadable.exit_code == 3);
  CHECK(lines_of(unreadable.out).size() + 1 == lines_of(test::read_text(list)).size());
}
