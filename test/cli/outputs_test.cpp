// The files left by a run: all outputs, or none; inputs are never replaced.
#include <algorithm>

#include <catch2/catch.hpp>

#include "base/json.h"
#include "files/result_file.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

/// Two recordings of 14 frames, and the database of the first one.
struct Walks {
  TemporaryFolder folder;
  Walks() {
    for (const std::string name : {"one", "two"}) {
      fs::create_directory(folder / name);
      for (int i = 0; i < 14; ++i)
        write_image(folder / name / (std::to_string(10 + i) + ".png"),
                    uint64_t(i + (name == "two" ? 100 : 0)));
    }
    run_ok("vpr-train", {"fastable", "--train", path("one"), "-o", path("d.vprdb")});
  }
  std::string path(const std::string& name) const { return folder / name; }
  RunOutcome query(Words more) const {
    return run_program("vpr-query", joined({path("d.vprdb"), "--c-l", "3", "--t-r", "0.8"}, more));
  }
  std::string read(const std::string& name) const { return read_text(path(name)); }
};

void check_sentence(const RunOutcome& outcome, int exit_code, const std::string& word) {
  INFO(outcome.err);
  CHECK(outcome.exit_code == exit_code);
  CHECK(has(outcome.err, word));
}

}  // namespace

TEST_CASE("a matrix of another result is refused") {
  const Walks walks;
  const auto eval = [&](const std::string& matrix) {
    return run_program("vpr-eval", {walks.path("a.json"), "--matrix", walks.path(matrix),
                                    "--ground-truth", "aligned"});
  };
  for (const std::string name : {"a", "b"})
    ok(walks.query({"--query", walks.path(name == "a" ? "two" : "one"), "-o",
                    walks.path(name + ".json"), "--save-matrix", walks.path(name + ".npy")}));
  CHECK(Json::parse(walks.read("a.json"))["files"].contains("matrix"));
  ok(eval("a.npy"));
  check_sentence(eval("b.npy"), 4, "is not the matrix that");
  ok(walks.query({"--query", walks.path("two"), "-o", walks.path("c.json")}));
  fs::rename(walks.path("c.json"), walks.path("a.json"));  // it names no matrix
  for (const std::string kind : {"recognitions", "recognition_scores", "best", "best_scores"})
    fs::rename(walks.path("c." + kind + ".npy"), walks.path("a." + kind + ".npy"));
  const auto unknown = ok(eval("a.npy"));
  CHECK(has(unknown.err, "no matrix was saved"));
}

TEST_CASE("a claimed number of frames costs nothing") {
  const Walks walks;
  ok(walks.query({"--query", walks.path("two"), "-o", walks.path("r.json")}));
  Json result = Json::parse(walks.read("r.json"));
  result["sequences"][0]["frames"] = 2147483647;
  result.erase("checksum");
  result["checksum"] = result_checksum(result);
  write_text(walks.path("r.json"), to_text(result));
  const auto eval = [&](Words more) {
    return run_program("vpr-eval", joined({walks.path("r.json")}, more)).exit_code;
  };
  CHECK(eval({"--html", walks.path("unknown.html")}) == 0);
  CHECK(eval({"--ground-truth", "aligned", "--html", walks.path("e.html"), "--plot",
              walks.path("plots"), "-o", walks.path("e.json"), "--recognitions-csv",
              walks.path("e.csv")}) == 0);
  run_ok("vpr-eval", {"convert", "aligned", "--result", walks.path("r.json"), "--to", "pairs", "-o",
                      walks.path("pairs.csv")});
}

TEST_CASE("an output never replaces an input of its run, not even with --force") {
  const Walks walks;
  write_text(walks.path("gt.csv"), "query,ref\n3,3\n");
  ok(walks.query({"--query", walks.path("two"), "-o", walks.path("r.json")}));
  const auto before = list_folder(walks.folder.path());
  const auto eval = [&](const std::string& output) {
    return run_program("vpr-eval", {walks.path("r.json"), "--ground-truth", walks.path("gt.csv"),
                                    "--force", "-o", walks.path(output)});
  };
  const std::string result = walks.read("r.json");
  CHECK(std::ranges::count(before, "r.keyframes.npy") == 1);
  for (const std::string& name : before)
    if (name.starts_with("r.") || name == "gt.csv")
      check_sentence(eval(name), 2, "is an input of this run");
  const auto query = [&](const std::string& output) {
    return walks.query({"--query", walks.path("two"), "--force", "-o", walks.path(output)});
  };
  for (const char* name : {"two/11.png", "d.vprdb/manifest.json"})
    check_sentence(query(name), 2, "is an input of this run");
  ok(query("r.json"));
  run_ok("vpr-train", {"add", walks.path("d.vprdb"), "--train", walks.path("two"), "--force", "-o",
                       walks.path("d.vprdb")});
  CHECK(list_folder(walks.folder.path()) == before);
  CHECK(walks.read("gt.csv") == "query,ref\n3,3\n");
}

TEST_CASE("the files of a data set are protected inputs as well") {
  const Walks walks;
  write_text(walks.path("gt.csv"), "query,ref\n3,3\n");
  write_text(walks.path("dataset.json"),
             R"({"schema": "vpr.dataset/3", "name": "w", "train": [{"name": "one",
                   "sequence": "one"}], "queries": [{"name": "two", "sequence": "two",
                   "ground_truth": {"format": "pairs", "path": "gt.csv"}}]})");
  for (const char* output : {"gt.csv", "two/10.png", "one/10.png"})
    check_sentence(
        walks.query({"--dataset", walks.path("dataset.json"), "--force", "-o", walks.path(output)}),
        2, "is an input of this run");
}

TEST_CASE("all outputs of an evaluation appear together, or none") {
  const Walks walks;
  ok(walks.query({"--query", walks.path("two"), "-o", walks.path("r.json")}));
  const auto before = list_folder(walks.folder.path());
  const auto eval = [&](Words more) {
    return run_program("vpr-eval",
                       joined({walks.path("r.json"), "--ground-truth", "aligned"}, more));
  };
  // The page fails after the report was computed: the sequence is not the evaluated one.
  fs::create_directory(walks.path("short"));
  fs::copy(walks.path("two/10.png"), walks.path("short/0.png"));
  check_sentence(eval({"-o", walks.path("e.json"), "--html", walks.path("e.html"), "--query",
                       walks.path("short")}),
                 2, "frames");
  fs::remove_all(walks.path("short"));
  CHECK(list_folder(walks.folder.path()) == before);
  for (const char* other : {"e.json", "../", "./e.json"})
    CHECK(eval({"-o", walks.path("e.json"), "--html", walks.path(other), "--force"}).exit_code ==
          2);
  CHECK(list_folder(walks.folder.path()) == before);
}

TEST_CASE("outputs that cannot be written are detected before the work") {
  const Walks walks;
  const auto before = list_folder(walks.folder.path());
  const auto train = [&](const std::string& name) {
    return run_program("vpr-train",
                       {"fastable", "--train", walks.path("one"), "-o", walks.path(name)});
  };
  // The companions' names are longer than the result's name.
  check_sentence(walks.query({"--query", walks.path("two"), "-o",
                              walks.path(std::string(248, 'x') + ".json")}),
                 3, "can't be written");
  check_sentence(train(std::string(256, 'x')), 3, "can't be written");
  CHECK(list_folder(walks.folder.path()) == before);
  ok(train(std::string(255, 'x')));
}

TEST_CASE("a folder of images is never mistaken for a folder of plots") {
  const Walks walks;
  ok(walks.query({"--query", walks.path("two"), "-o", walks.path("r.json")}));
  fs::create_directories(walks.path("one/sub.png/thesis"));
  const auto frames = list_folder(walks.path("one"));
  check_sentence(run_program("vpr-eval", {walks.path("r.json"), "--ground-truth", "aligned",
                                          "--plot", walks.path("one"), "--force"}),
                 2, "is not replaced");
  CHECK(list_folder(walks.path("one")) == frames);
}
