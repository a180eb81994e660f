// Bad input: one sentence, the correct exit code, and no partial output.
#include <algorithm>
#include <cmath>
#include <map>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sys/wait.h>

#include "cli/world.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

// Two short training sequences, a query and a database with c_l 5.
void make_short_walks() {
  write_walk("one", 8, 1);
  write_walk("two", 8, 9);
  write_walk("query", 8, 17);
  fs::create_directory("empty");
  run_ok("vpr-train fastable --c-l 5 --train one --train two -o db.vprdb");
}

const std::string kTrainShort = "vpr-train fastable --c-l 5";
const std::string kQueryShort = "vpr-query db.vprdb --query query -o r.json";

// The inputs of refused.txt.
void make_inputs() {
  make_short_walks();
  std::string poses;
  for (int i = 0; i < 40; ++i) poses += fmt::format("{} {} 0 0 0 0 0 1\n", 100 + i, i);
  for (const auto& [name, text] : std::map<std::string, std::string>{
           {"falling.csv", "1\n2\n1.5\n"},
           {"repeated.csv", "1\n2\n2\n"},
           {"few.csv", "1\n2\n3\n"},
           {"marked.csv", "sequence,train,query,tolerance\nnowhere,3,5,2\n"},
           {"cut.npy", "\x93NUMPY"},
           {"g.csv", "query,reference\n0,0\n5,3\n"},
           {"named.csv", "query,reference\na.png,b.png\n"},
           {"unnamed.csv", "query,sequence,reference\nnone.png,one,1\n"},
           {"blank.csv", "query,sequence,reference\n0,,3\n1,b,1\n2,a,0\n"},
           {"flat.csv", "frame,x,y\n0,0,0\n"},
           {"z.csv", "frame,x,y,z\n0,0,0,1\n"},
           {"odd.csv", "frame,x,y,weight\n0,1,1,2\n"},
           {"xy.csv", "x,y\n1.5,0\n"},
           {"p.txt", "0 1 0.5\n"},
           {"laps.txt", poses},
           {"closures.csv", "query,match,score\n30,2,0.9\n"},
           {"both-ways.csv", "30,2\n2,30\n"},
           {"beyond.csv", "30,2\n300,2\n"},
           {"filter.json", R"({"method": "filter"})"},
           {"lsh.json", R"({"method": "lsh"})"},
           {"hog.json", R"({"descriptor": "hog"})"},
           {"unknown.json", R"({"t_l": 5})"},
           {"empty.json", R"({"method": ""})"},
           {"place.json", R"({"c_l": 5, "t_p": 0.3})"},
           {"radius.json", R"({"clustering": {"eps": -1}})"}})
    write_text(name, text);
  const auto write_floats = [](const std::string& name, size_t rows, size_t length, int missing) {
    std::vector<float> values(rows * length);
    for (size_t i = 0; i < values.size(); ++i) values[i] = float((i * i + rows) % 101) + 1;
    std::fill_n(values.begin() + 2 * length, missing, NAN);
    write_array(name, values, {rows, length});
  };
  write_floats("s.npy", 12, 12, 0);
  write_floats("db.npy", 60, 48, 0);
  write_floats("q.npy", 24, 48, 0);
  write_floats("short.npy", 4, 10, 0);
  write_floats("nan.npy", 4, 48, 1);
  write_floats("gap.npy", 9, 48, 48);
  write_array<uint8_t>("bits.npy", {1, 2, 3, 7, 1, 4}, {3, 2});
  write_array<uint8_t>("wide.npy", {1, 2, 3, 7, 1, 2}, {2, 3});
  write_array("large.npy", std::vector<int64_t>(25, int64_t{1} << 60), {5, 5});
  write_text("truncated.npy", read_text("db.npy").substr(0, 1000));
  run_ok(
      "vpr-train descriptors --train db.npy --sequence a=0:28 --sequence b=28:60 -o vectors.vprdb");
  run_ok("vpr-train fastable --train $one -o one.vprdb");
  run_ok("vpr-query loops --query query --c-l 4 --gap 3 -o loops.json");
  run_ok(kQueryShort + " --c-l 5");
}

}  // namespace

TEST_CASE("mistakes are refused with their exit code and one sentence, and write nothing") {
  start_with(make_inputs);
  const auto before = list_folder(".");
  std::string begin;
  for (const std::string& line : lines_of(read_text(source_path("test/cli/refused.txt")))) {
    if (line.empty() || line.front() == '#') continue;
    const size_t bar = line.find(" | ");
    if (line.starts_with("vpr-"))
      begin = line;
    else
      check_failure(begin + line.substr(1, bar - 1), line.front() - '0', line.substr(bar + 3));
  }
  CHECK(list_folder(".") == before);
  check_failure(run("vpr-query db.vprdb --query query", "VPR_SIMD=AVX9"), 2, "choose one of");
}

TEST_CASE("numbers may begin with a point or a plus, or have an exponent") {
  start_with(make_short_walks);
  const Json settings = printed_json(kQueryShort + " --c-l 5 --t-r 0.5 --json")["settings"];
  for (const std::string numbers : {" --c-l 5 --t-r .5", " --c-l +5 --t-r 5e-1"})
    CHECK(printed_json(kQueryShort + numbers + " --json --force")["settings"] == settings);
}

TEST_CASE("an existing output is refused before any work, and replaced with --force") {
  start_with(make_short_walks);
  write_text("r.json", "precious");
  check_failure(kQueryShort, 2, "--force");
  CHECK(read_text("r.json") == "precious");
  for (int i = 0; i < 2; ++i) run_ok(kQueryShort + " --c-l 5 --force");
  // A folder with files of other programs is never replaced.
  fs::create_directory("extension");
  write_text("extension/manifest.json", R"({"manifest_version": 3})");
  fs::copy("db.vprdb", "mixed");
  write_text("mixed/notes.txt", "mine");
  for (const std::string name : {"two", "extension", "mixed"})
    check_failure(kTrainShort + " --train one --force -o " + name, 2, "is not replaced");
  fs::create_directory("recordings");
  write_text("recordings/dataset.json", "{}");
  write_walk("recordings/rec", 1, 1);
  check_failure(
      "vpr-synth --force -o recordings " + source_path("configs/worlds/small.json").string(), 2,
      "is not replaced");
  for (const char* kept :
       {"two/07.png", "extension/manifest.json", "mixed/notes.txt", "recordings/rec/00.png"})
    CHECK(fs::exists(kept));
}

TEST_CASE("a failure of stdout or stderr changes nothing else") {
  if (!fs::exists("/dev/full")) return;
  start_with(make_short_walks);
  const auto shell = [](const std::string& command, const char* to = " > /dev/full 2> said") {
    const int status = std::system((program_path("").string() + command + to).c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  };
  CHECK(shell("vpr-train info db.vprdb") == 3);
  for (const char* stderr_to : {" > said 2> /dev/full", " > said 2>&-"})
    CHECK(shell("vpr-train info missing", stderr_to) == 3);
  const auto query = [&](const std::string& flags) {
    const int exit_code = shell(kQueryShort + " --c-l 2" + flags);
    CHECK(has(read_text("said"), "the output files are complete"));
    CHECK(fs::remove("r.json"));
    return exit_code;
  };
  CHECK(query("") == 0);
  CHECK(query(" --force --json") == 3);  // standard output is an output as well
}

TEST_CASE("names cannot control a terminal, and an error is a single line") {
  start_with(make_short_walks);
  const std::string hostile = "a\x1b[31m\x07\nb";
  const auto check_plain = [](const RunOutcome& outcome) {
    CHECK(std::ranges::none_of(outcome.out + outcome.err,
                               [](char c) { return (c < ' ' && c != '\n') || c == '\x7f'; }));
  };
  check_failure("vpr-train info " + hostile, 3, "a\\x1b[31m\\x07\\x0ab");
  check_failure("vpr-query db.vprdb --" + hostile, 2, "\\x1b");
  fs::copy("one", hostile);
  const auto train = run_ok(kTrainShort + " --train " + hostile + " -o " + hostile + ".vprdb");
  CHECK(has(train.out, "a\\x1b[31m\\x07\\x0ab"));
  check_plain(train);
  check_plain(run_ok("vpr-query " + hostile + ".vprdb --query " + hostile + " --c-l 2 --t-r 0.5"));
}

TEST_CASE("libraries print no messages about images") {
  cv::Mat noise(48, 64, CV_8UC1);
  cv::randu(noise, 0, 256);
  const auto encoded = [&](const std::string& extension) {
    std::vector<uint8_t> bytes;
    cv::imencode(extension, noise, bytes);
    return std::string(bytes.begin(), bytes.end());
  };
  const auto train = [&](const std::string& extension, const std::string& bytes) {
    fs::remove_all("walk");
    write_walk("walk", 6, 0, 64, 48);
    write_text("walk/6" + extension, bytes);
    return run("vpr-train fastable --train walk --force -o x.vprdb");
  };
  const std::string png = encoded(".png");
  const std::string jpeg = encoded(".jpg");
  std::string comment = png;  // with a wrong checksum
  comment.insert(33, std::string("\0\0\0\3tEXta\0b....", 15));
  std::string flipped = png;
  flipped[png.size() / 2] = static_cast<char>(~flipped[png.size() / 2]);
  std::string header = png;
  header[24] = 7;  // bits per pixel
  const std::vector<std::pair<std::string, std::string>> damaged = {
      {".png", flipped},
      {".png", header},
      {".png", png.substr(0, 60)},
      {".jpg", jpeg.substr(0, 30) + jpeg.substr(200)},
      {".tiff", encoded(".tiff").substr(0, 100)},
      {".webp", encoded(".webp").substr(0, 100)},
      {".png", encoded(".jp2")},
      {".bmp", encoded(".bmp").substr(0, 100)},
      {".pgm", encoded(".pgm").substr(0, 100)}};
  for (const auto& [extension, bytes] : damaged)
    check_failure(train(extension, bytes), 3, "6" + extension + ": can't be decoded");
  // Readable images that cause messages of a library.
  for (const auto& [extension, bytes] :
       {std::pair<std::string, std::string>{".png", comment},
        {".jpg", jpeg.substr(0, jpeg.size() - 2) + "xx\xff\xd9"}}) {
    const auto outcome = ok(train(extension, bytes));
    CHECK(outcome.err.empty());
  }
}

TEST_CASE("frames above the size limit are refused, or accepted with a higher limit") {
  write_walk("big", 6, 0, 1200, 1000);
  write_text("c.json", R"({"max_megapixels": 1})");
  const std::string train = kTrainShort + " --train big --force -o x.vprdb";
  check_failure(train + " --max-megapixels 1", 2, "0.png: has 1200 x 1000 pixels");
  check_failure(train + " --max-megapixels 0", 2, "from 1 to 1073");
  check_failure(train + " --config c.json", 2, "--max-megapixels 2");
  run_ok(train + " --config c.json --max-megapixels 2");
  run_ok(train);
}
