// Bad input: one sentence, the correct exit code, and no partial output.
#include <algorithm>

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
void make_walks() {
  write_walk("one", 8, 1);
  write_walk("two", 8, 9);
  write_walk("query", 8, 17);
  fs::create_directory("empty");
  run_ok("vpr-train fastable --c-l 5 --train one --train two -o db.vprdb");
}

const std::string kTrain = "vpr-train fastable --c-l 5";
const std::string kQuery = "vpr-query db.vprdb --query query -o r.json";

// Checks that the folder is unchanged: no result, no temporary file.
void check_nothing_written() {
  CHECK(list_folder(".") == Words{"db.vprdb", "empty", "one", "query", "two"});
}

}  // namespace

TEST_CASE("sequences and databases that are missing, empty or out of range are refused") {
  start_with(make_walks);
  check_refused(kTrain, {{"--train none -o x.vprdb", 3, "none"},
                         {"--train empty -o x.vprdb", 3, "no images"},
                         {"--train one@0:9 -o x.vprdb", 2, "8 frames"},
                         {"--train one@5:2 -o x.vprdb", 2, "range"},
                         {"--train one --train one -o x.vprdb", 2, "once"},
                         {"-o x.vprdb", 2, "--train"},
                         {"--train one", 2, "-o"},
                         {"--train-folders one -o x.vprdb", 3, "subfolders"},
                         {"--train one -o /proc/x.vprdb", 3, "can't be written"}});
  check_refused("vpr-train info",
                {{"none.vprdb", 3, "no such database"}, {"one", 4, "is not a database"}});
  check_nothing_written();
}

TEST_CASE("settings out of range, and flags of another method, are refused") {
  start_with(make_walks);
  check_refused(kQuery, {{"--c-l 0", 2, "c_l"},
                         {"--c-l -3", 2, "c-l"},
                         {"--c-l 9", 2, "smaller --c-l"},
                         {"--c-l 99999999999999999999", 2, "c-l"},
                         {"--c-l 5 --t-r nan", 2, "t-r"},
                         {"--c-l 5 --t-r 1e999", 2, "t-r"},
                         {"--c-l 5 --t-r -1", 2, "t_r"},
                         {"--c-l 5 --t-r-scale bytes", 2, "relative"},
                         {"--c-l 5 --method fastabel", 2, "openable"},
                         {"--c-l 5 --max-memory lots", 2, "512M"},
                         {"--c-l 5 --save-matrix m.tiff", 2, ".npy"},
                         {"--c-l 5 --save-matrix no/m.npy", 3, "does not exist"},
                         {"--c-l 5 --threads x", 2, "threads"},
                         {"--c-l 5 --only-sequence three", 2, "one, two"},
                         {"--seed 99999999999999999999999", 2, "seed"},
                         {"--verify -1", 2, "verify"},
                         {"--t-p 0.5", 2, "--t-p"},
                         {"--method fabmap", 4, "fabmap"},
                         {"--c-l 5 --t-r 55", 2, "--t-r 55 --t-r-scale bits"},
                         {"--c-l 5 --score zscore --t-r 0.5", 2, "--t-r -1.5"}});
  check_refused("vpr-query", {{"", 2, "DB"}, {"--no-such-flag", 2, "--help"}});
  check_failure(run(kQuery, "VPR_SIMD=AVX9"), 2, "choose one of");
  check_nothing_written();
  ok(run(kQuery + " --c-l 5 --t-r .5"));
  ok(run(kQuery + " --c-l +5 --t-r 5e-1 --force"));
}

TEST_CASE("an existing output is refused before any work, and replaced with --force") {
  start_with(make_walks);
  write_text("r.json", "precious");
  check_failure(kQuery, 2, "--force");
  CHECK(read_text("r.json") == "precious");
  for (int i = 0; i < 2; ++i) run_ok(kQuery + " --c-l 5 --force");
  // A folder with files of other programs is never replaced.
  fs::create_directory("extension");
  write_text("extension/manifest.json", R"({"manifest_version": 3})");
  fs::copy("db.vprdb", "mixed");
  write_text("mixed/notes.txt", "mine");
  for (const std::string name : {"two", "extension", "mixed"})
    check_failure(kTrain + " --train one --force -o " + name, 2, "is not replaced");
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

TEST_CASE("writing an output twice is refused, and a failed run leaves no matrix") {
  start_with(make_walks);
  check_refused(kQuery + " --c-l 5 --t-r 1",
                {{"--force --save-matrix r.recognitions.npy", 2, "written twice"},
                 {"--max-memory 1 --save-matrix d.npy", 2, "recognitions"}});
  check_nothing_written();
}

TEST_CASE("a failure of stdout does not lose the requested files") {
  if (!fs::exists("/dev/full")) return;
  start_with(make_walks);
  const auto shell = [](const std::string& command) {
    const auto programs = program_path("").string();
    return WEXITSTATUS(std::system((programs + command + " > /dev/full 2> said").c_str()));
  };
  CHECK(shell("vpr-train info db.vprdb") == 3);
  const auto query = [&](const std::string& flags) {
    const int exit_code = shell(kQuery + " --c-l 2" + flags);
    CHECK(has(read_text("said"), "the output files are complete"));
    CHECK(fs::remove("r.json"));
    return exit_code;
  };
  CHECK(query("") == 0);
  CHECK(query(" --force --json") == 3);  // standard output is an output as well
}

TEST_CASE("names cannot control a terminal, and an error is a single line") {
  start_with(make_walks);
  const std::string hostile = "a\x1b[31m\x07\nb";
  const auto check_plain = [](const RunOutcome& outcome) {
    CHECK(std::ranges::none_of(outcome.out + outcome.err,
                               [](char c) { return (c < ' ' && c != '\n') || c == '\x7f'; }));
  };
  check_failure("vpr-train info " + hostile, 3, "a\\x1b[31m\\x07\\x0ab");
  check_failure("vpr-query db.vprdb --" + hostile, 2, "\\x1b");
  fs::copy("one", hostile);
  const auto train = run_ok(kTrain + " --train " + hostile + " -o " + hostile + ".vprdb");
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
  const std::string train = kTrain + " --train big --force -o x.vprdb";
  check_refused(train, {{"--max-megapixels 1", 2, "0.png: has 1200 x 1000 pixels"},
                        {"--max-megapixels 0", 2, "from 1 to 1073"},
                        {"--config c.json", 2, "--max-megapixels 2"}});
  run_ok(train + " --config c.json --max-megapixels 2");
  run_ok(train);
}

TEST_CASE("ground truth that is missing or does not match is refused") {
  start_with(make_walks);
  run_ok(kQuery + " --c-l 5");
  CHECK(has(run_ok("vpr-eval r.json").out, "Nothing is judged"));
  check_refused("vpr-eval", {{"r.json --ground-truth no.csv", 3, "no.csv"},
                             {"r.json --ground-truth aligned", 2, "exactly one"},
                             {"db.vprdb/manifest.json --ground-truth aligned", 4, "vpr.result/3"}});
}
