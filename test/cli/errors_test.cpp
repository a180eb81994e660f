// Bad input: one sentence, the correct exit code, and no partial output.
#include <algorithm>
#include <array>
#include <csignal>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <pty.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/building.h"
#include "cli/world.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

/// Two short training sequences, a query and a database with c_l 5.
struct Bench {
  TemporaryFolder folder;
  Bench() {
    uint64_t seed = 0;
    for (const char* name : {"one", "two", "query"}) {
      fs::create_directory(folder / name);
      for (int i = 0; i < 8; ++i) write_image(folder / name / fmt::format("{}.png", i), ++seed);
    }
    fs::create_directory(folder / "empty");
    ok(train({"--train", folder / "one", "--train", folder / "two", "-o", database()}));
  }
  std::string database() const { return folder / "db.vprdb"; }
  static RunOutcome train(Words words) {
    return run_program("vpr-train", joined({"fastable", "--c-l", "5"}, words));
  }
  RunOutcome query(Words words) const {
    return run_program(
        "vpr-query",
        joined({database(), "--query", folder / "query", "-o", folder / "r.json"}, words));
  }
};

const Bench& bench() {
  static const Bench kShared;
  return kShared;
}

// Also checks that the output has no result.
void check_refused(const RunOutcome& outcome, int exit_code, const std::string& word) {
  CHECK(outcome.out.empty());
  check_failure(outcome, exit_code, word);
}

// Checks that the folder is unchanged: no result, no temporary file.
void check_nothing_written() {
  CHECK(list_folder(bench().folder.path()) == Words{"db.vprdb", "empty", "one", "query", "two"});
}

}  // namespace

TEST_CASE("sequences that are missing, empty or out of range are refused") {
  const auto& folder = bench().folder;
  const std::string out = folder / "x.vprdb";
  check_refused(Bench::train({"--train", folder / "none", "-o", out}), 3, "none");
  check_refused(Bench::train({"--train", folder / "empty", "-o", out}), 3, "no images");
  check_refused(Bench::train({"--train", (folder / "one").string() + "@0:9", "-o", out}), 2,
                "8 frames");
  check_refused(Bench::train({"--train", (folder / "one").string() + "@5:2", "-o", out}), 2,
                "range");
  check_refused(Bench::train({"--train", folder / "one", "--train", folder / "one", "-o", out}), 2,
                "once");
  check_refused(Bench::train({"-o", out}), 2, "--train");
  check_refused(Bench::train({"--train", folder / "one"}), 2, "-o");
  check_refused(Bench::train({"--train-folders", folder / "one", "-o", out}), 3, "subfolders");
  check_nothing_written();
}

TEST_CASE("settings out of range are refused") {
  check_refused(bench().query({"--c-l", "0"}), 2, "c_l");
  check_refused(bench().query({"--c-l", "-3"}), 2, "c-l");
  check_refused(bench().query({"--c-l", "9"}), 2, "smaller --c-l");
  check_refused(bench().query({"--c-l", "99999999999999999999"}), 2, "c-l");
  check_refused(bench().query({"--c-l", "5", "--t-r", "nan"}), 2, "t-r");
  check_refused(bench().query({"--c-l", "5", "--t-r", "1e999"}), 2, "t-r");
  check_refused(bench().query({"--c-l", "5", "--t-r", "-1"}), 2, "t_r");
  check_refused(bench().query({"--c-l", "5", "--t-r-scale", "bytes"}), 2, "relative");
  check_refused(bench().query({"--c-l", "5", "--method", "fastabel"}), 2, "openable");
  for (const char* size : {"lots", "5X", "17179869184G"})
    check_refused(bench().query({"--c-l", "5", "--max-memory", size}), 2, "512M");
  check_refused(bench().query({"--c-l", "5", "--save-matrix", "m.tiff"}), 2, ".npy");
  check_refused(bench().query({"--c-l", "5", "--threads", "x"}), 2, "threads");
  check_refused(run_program("vpr-query", {}), 2, "DB");
  check_refused(run_program("vpr-query", {"--no-such-flag"}), 2, "--help");
  check_refused(run_program("vpr-query", {bench().database(), "--query", "q"}, {"VPR_SIMD=AVX9"}),
                2, "choose one of");
  check_nothing_written();
}

TEST_CASE("thresholds on another scale are refused, and the converted one is suggested") {
  check_refused(bench().query({"--c-l", "5", "--t-r", "55"}), 2, "--t-r 55 --t-r-scale bits");
  check_refused(bench().query({"--c-l", "5", "--score", "zscore", "--t-r", "0.5"}), 2,
                "--t-r -1.5");
}

TEST_CASE("missing, invalid, damaged or newer databases are refused") {
  const TemporaryFolder out;
  const auto info = [&](const std::string& path) {
    return run_program("vpr-train", {"info", path});
  };
  check_refused(info(out / "none.vprdb"), 3, "no such database");
  check_refused(info(bench().folder / "one"), 4, "is not a database");
  const auto damaged = [&](const std::string& name, auto change) {
    fs::remove_all(out / "d.vprdb");
    fs::copy(bench().database(), out / "d.vprdb");
    std::string text = read_text(out / "d.vprdb" / name);
    change(text);
    write_text(out / "d.vprdb" / name, text);
    return info(out / "d.vprdb");
  };
  check_refused(damaged("codes.npy", [](std::string& t) { t[t.size() - 9] ^= 1; }), 4, "checksum");
  check_refused(damaged("manifest.json",
                        [](std::string& t) { t.replace(t.find("database/3"), 10, "database/7"); }),
                4, "another version");
  check_refused(
      damaged("manifest.json",
              [](std::string& t) { t.replace(t.find("vpr.database"), 12, "vpr.resultss"); }),
      4, "expected schema");
}

TEST_CASE("an existing output is refused before any work, and replaced with --force") {
  const TemporaryFolder out;
  write_text(out / "r.json", "precious");
  const auto query = [&](Words more) {
    return run_program("vpr-query", joined({bench().database(), "--query", bench().folder / "query",
                                            "--c-l", "5", "-o", out / "r.json"},
                                           more));
  };
  check_refused(query({}), 2, "--force");
  CHECK(read_text(out / "r.json") == "precious");
  ok(query({"--force"}));
  ok(query({"--force"}));
  check_refused(
      Bench::train({"--train", bench().folder / "one", "--force", "-o", bench().folder / "two"}), 2,
      "is not replaced");
  CHECK(list_folder(bench().folder / "two").size() == 8);
}

TEST_CASE("--force never replaces a folder with files of other programs") {
  const TemporaryFolder out;
  fs::create_directory(out / "extension");
  write_text(out / "extension/manifest.json", R"({"manifest_version": 3})");
  fs::copy(bench().database(), out / "mixed");
  write_text(out / "mixed/notes.txt", "mine");
  fs::create_directory(out / "recordings");
  write_text(out / "recordings/dataset.json", "{}");
  fs::create_directory(out / "recordings/rec");
  write_image(out / "recordings/rec/1.png", 1);
  for (const char* name : {"extension", "mixed"})
    check_refused(Bench::train({"--train", bench().folder / "one", "--force", "-o", out / name}), 2,
                  "is not replaced");
  check_refused(run_program("vpr-synth", {source_path("configs/worlds/small.json"), "--force", "-o",
                                          out / "recordings"}),
                2, "is not replaced");
  CHECK(fs::exists(out / "recordings/rec/1.png"));
  CHECK(fs::exists(out / "mixed/notes.txt"));
}

TEST_CASE("hostile nesting is an error, not a crash") {
  const TemporaryFolder out;
  const std::string deep = std::string(200'000, '[') + std::string(200'000, ']');
  write_text(out / "c.json", R"({"c_l": )" + deep + "}");
  check_refused(bench().query({"--config", out / "c.json"}), 2, "not valid JSON");
  write_text(out / "r.json", R"({"schema": "vpr.result/3", "x": )" + deep + "}");
  check_refused(run_program("vpr-eval", {out / "r.json", "--ground-truth", "aligned"}), 4,
                "not valid JSON");
}

TEST_CASE("writing an output twice is refused, and a failed run leaves no matrix") {
  const TemporaryFolder out;
  const Words base = {bench().database(), "--query", bench().folder / "query", "--c-l", "5", "-o",
                      out / "m.json"};
  auto twice = joined(base, {"--force", "--save-matrix", out / "m.recognitions.npy"});
  check_refused(run_program("vpr-query", twice), 2, "written twice");
  check_refused(run_program("vpr-query", joined(base, {"--max-memory", "1", "--t-r", "1",
                                                       "--save-matrix", out / "d.npy"})),
                2, "recognitions");
  CHECK(list_folder(out.path()).empty());
}

TEST_CASE("numbers have common notations and are checked for their range") {
  const TemporaryFolder out;
  ok(bench().query({"--c-l", "5", "--t-r", ".5", "--json", "--force"}));
  ok(bench().query({"--c-l", "+5", "--t-r", "5e-1", "--json", "--force"}));
  for (const char* kind : {"r.json", "r.recognitions.npy", "r.recognition_scores.npy", "r.best.npy",
                           "r.best_scores.npy", "r.margins.npy", "r.keyframes.npy"})
    fs::remove(bench().folder / kind);
  check_refused(bench().query({"--threads", "-1"}), 2, "threads");
  check_refused(bench().query({"--seed", "99999999999999999999999"}), 2, "seed");
  check_refused(bench().query({"--verify", "-1"}), 2, "verify");
}

TEST_CASE("flags of the other family are refused") {
  check_refused(bench().query({"--t-p", "0.5"}), 2, "--t-p");
  check_refused(bench().query({"--method", "fabmap"}), 4, "fabmap");
}

TEST_CASE("outputs that cannot be written are refused") {
  check_refused(bench().query({"--c-l", "5", "--save-matrix", bench().folder / "no/m.npy"}), 3,
                "does not exist");
  check_refused(Bench::train({"--train", bench().folder / "one", "-o", "/proc/x.vprdb"}), 3,
                "can't be written");
  if (fs::exists("/dev/full")) {
    const std::string command = (program_path("vpr-train")).string() + " info " +
                                bench().database() + " > /dev/full 2>/dev/null";
    CHECK(WEXITSTATUS(std::system(command.c_str())) == 3);
  }
  check_nothing_written();
}

TEST_CASE("a failure of stdout does not lose the requested files") {
  if (!fs::exists("/dev/full")) return;
  const TemporaryFolder out;
  const auto query = [&](const std::string& flags) {
    const std::string command = fmt::format(
        "{} {} --query {} --c-l 2 -o {} --force {} > /dev/full 2> {}",
        program_path("vpr-query").string(), bench().database(), (bench().folder / "query").string(),
        (out / "r.json").string(), flags, (out / "said").string());
    const int exit_code = WEXITSTATUS(std::system(command.c_str()));
    CHECK(has(read_text(out / "said"), "the output files are complete"));
    CHECK(fs::exists(out / "r.json"));
    fs::remove(out / "r.json");
    return exit_code;
  };
  CHECK(query("") == 0);
  CHECK(query("--json") == 3);  // standard output is an output as well
}

TEST_CASE("names cannot control a terminal, and an error is a single line") {
  const TemporaryFolder out;
  const std::string hostile = "a\x1b[31m\x07\nb";
  const auto is_plain = [](const std::string& text) {
    return std::none_of(text.begin(), text.end(),
                        [](char c) { return (c < ' ' && c != '\n') || c == '\x7f'; });
  };
  check_refused(run_program("vpr-train", {"info", out / hostile}), 3, "a\\x1b[31m\\x07\\x0ab");
  check_refused(run_program("vpr-query", {bench().database(), "--" + hostile}), 2, "\\x1b");
  fs::copy(bench().folder / "one", out / hostile);
  const auto train = ok(Bench::train({"--train", out / hostile, "-o", out / (hostile + ".vprdb")}));
  CHECK(has(train.out, "a\\x1b[31m\\x07\\x0ab"));
  CHECK(is_plain(train.out));
  CHECK(is_plain(train.err));
  const auto query = run_ok("vpr-query", {out / (hostile + ".vprdb"), "--query", out / hostile,
                                          "--c-l", "2", "--t-r", "0.5"});
  CHECK(is_plain(query.out));
  CHECK(is_plain(query.err));
}

TEST_CASE("a full disk leaves nothing behind") {
  const TemporaryFolder disk;
  if (::mount("tmpfs", disk.path().c_str(), "tmpfs", 0, "size=64k") != 0) {
    WARN("skipped: no permission to mount a small disk");
    return;
  }
  fs::create_directory(disk / "sub");
  // One image per frame is small, so fill the disk first.
  write_text(disk / "ballast", std::string(60 * 1024, 'x'));
  const auto train = Bench::train({"--train", bench().folder / "one", "--train",
                                   bench().folder / "two", "-o", disk / "sub/db.vprdb"});
  const auto left = list_folder(disk / "sub");
  const auto query =
      run_program("vpr-query", {bench().database(), "--query", bench().folder / "query", "--c-l",
                                "5", "-o", disk / "sub/r.json"});
  const auto left_after_query = list_folder(disk / "sub");
  ::umount(disk.path().c_str());
  check_refused(train, 3, "No space left");
  CHECK(left.empty());
  check_refused(query, 3, "No space left");
  CHECK(left_after_query.empty());
}

TEST_CASE("a folder that cannot be created on a full disk is an output error") {
  const TemporaryFolder world;
  write_text(world / "world.json", building(2, {"one"}));
  const TemporaryFolder disk;
  for (const char* files : {"nr_inodes=2", "nr_inodes=3", "nr_inodes=4"}) {
    if (::mount("tmpfs", disk.path().c_str(), "tmpfs", 0, files) != 0) {
      WARN("skipped: no permission to mount a small disk");
      return;
    }
    const auto synth = run_program("vpr-synth", {world / "world.json", "-o", disk / "walk"});
    const auto left = list_folder(disk.path());
    ::umount(disk.path().c_str());
    check_refused(synth, 3, "No space left");
    CHECK(left.empty());
  }
}

TEST_CASE("libraries print no messages about images") {
  const TemporaryFolder out;
  cv::Mat noise(48, 64, CV_8UC1);
  cv::randu(noise, 0, 256);
  const auto encoded = [&](const std::string& extension) {
    std::vector<uint8_t> bytes;
    cv::imencode(extension, noise, bytes);
    return std::string(bytes.begin(), bytes.end());
  };
  const auto train = [&](const std::string& extension, const std::string& bytes) {
    fs::remove_all(out / "walk");
    fs::create_directory(out / "walk");
    for (int i = 0; i < 6; ++i)
      write_image(out / "walk" / fmt::format("{}.png", i), static_cast<uint64_t>(i), 64, 48);
    write_text(out / "walk" / ("6" + extension), bytes);
    return run_program("vpr-train",
                       {"fastable", "--train", out / "walk", "--force", "-o", out / "x.vprdb"});
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
    check_refused(train(extension, bytes), 3, "6" + extension + ": can't be decoded");
  // Readable images that cause messages of a library.
  for (const auto& [extension, bytes] :
       {std::pair<std::string, std::string>{".png", comment},
        {".jpg", jpeg.substr(0, jpeg.size() - 2) + "xx\xff\xd9"}}) {
    const auto outcome = ok(train(extension, bytes));
    CHECK(outcome.err.empty());
  }
}

TEST_CASE("frames above the size limit are refused, or accepted with a higher limit") {
  const TemporaryFolder out;
  for (int i = 0; i < 6; ++i)
    write_image(out / fmt::format("{}.png", i), static_cast<uint64_t>(i), 1200, 1000);
  const auto train = [&](Words more) {
    return Bench::train(joined({"--train", out.path(), "--force", "-o", out / "x.vprdb"}, more));
  };
  check_refused(train({"--max-megapixels", "1"}), 2, "0.png: has 1200 x 1000 pixels");
  check_refused(train({"--max-megapixels", "0"}), 2, "from 1 to 1073");
  write_text(out / "c.json", R"({"max_megapixels": 1})");
  check_refused(train({"--config", out / "c.json"}), 2, "--max-megapixels 2");
  ok(train({"--config", out / "c.json", "--max-megapixels", "2"}));
  ok(train({}));
}

TEST_CASE("ground truth that is missing or does not match is refused") {
  const TemporaryFolder out;
  run_ok("vpr-query", {bench().database(), "--query", bench().folder / "query", "--c-l", "5", "-o",
                       out / "r.json"});
  const auto eval = [&](const std::string& csv) {
    write_text(out / "g.csv", csv);
    return run_program("vpr-eval", {out / "r.json", "--ground-truth", out / "g.csv"});
  };
  check_refused(run_program("vpr-eval", {out / "r.json", "--ground-truth", out / "no.csv"}), 3,
                "no.csv");
  CHECK(has(run_ok("vpr-eval", {out / "r.json"}).out, "Nothing is judged"));
  check_refused(run_program("vpr-eval", {out / "r.json", "--ground-truth", "aligned"}), 2,
                "exactly one");
  check_refused(eval("query,sequence,reference\n0,one,8\n"), 4, "out of range");
  check_refused(eval("query,sequence,reference\n8,one,0\n"), 4, "line 2");
  check_refused(eval("query,sequence,reference\n0,three,0\n"), 4, "three");
  check_refused(eval("query,reference\n0,0\n"), 2, "exactly one");
  check_refused(eval("nonsense"), 4, "header");
  check_refused(
      run_program("vpr-eval", {bench().database() + "/manifest.json", "--ground-truth", "aligned"}),
      4, "vpr.result/3");
}

TEST_CASE("an interrupt during training exits with 130 and leaves nothing behind") {
  const TemporaryFolder folder;
  fs::create_directory(folder / "long");
  write_image(folder / "long/0.png", 1, 1500, 1100);
  std::string list;
  for (int i = 0; i < 3000; ++i) list += "long/0.png\n";
  write_text(folder / "long.txt", list);
  const std::string program = program_path("vpr-train").string();
  const std::string input = folder / "long.txt";
  const std::string output = folder / "db.vprdb";
  int terminal = -1;
  const pid_t child = ::forkpty(&terminal, nullptr, nullptr, nullptr);
  REQUIRE(child >= 0);
  if (child == 0) {
    ::execl(program.c_str(), program.c_str(), "fastable", "--train", input.c_str(), "-o",
            output.c_str(), nullptr);
    ::_exit(99);
  }
  std::array<char, 256> text{};
  REQUIRE(::read(terminal, text.data(), text.size()) > 0);  // progress shows that it is running
  ::kill(child, SIGINT);
  while (::read(terminal, text.data(), text.size()) > 0) {
  }
  ::close(terminal);
  int status = 0;
  ::waitpid(child, &status, 0);
  REQUIRE(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 130);
  CHECK(list_folder(folder.path()) == Words{"long", "long.txt"});
}
