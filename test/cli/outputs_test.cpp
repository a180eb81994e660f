// The files left by a run: all outputs, or none; inputs are never replaced.
#include <algorithm>

#include <catch2/catch.hpp>
#include <sys/resource.h>

#include "query/result_file.h"
#include "world.h"

using namespace vpr;
using namespace vpr::test;

namespace {

// Two recordings of 14 frames, the database of the first one, and a ground truth.
void make_walks() {
  write_walk("one", 14, 0);
  write_walk("two", 14, 100);
  run_ok("vpr-train fastable --train one -o d.vprdb");
  write_text("gt.csv", "query,ref\n3,3\n");
}

const std::string kQuery = "vpr-query d.vprdb --c-l 3 --t-r 0.8 ";
const std::string kTwo = kQuery + "--query two -o r.json ";

// Requires that the command fails and changes no name in the folder.
void check_unchanged(const std::string& command, int exit_code, const std::string& word) {
  const auto before = list_folder(".");
  const auto outcome = run(command);
  INFO(command << ": " << outcome.err);
  CHECK(outcome.exit_code == exit_code);
  CHECK(has(outcome.err, word));
  CHECK(list_folder(".") == before);
}

}  // namespace

TEST_CASE("a matrix of another result is refused") {
  start_with(make_walks);
  run_ok(kQuery + "--query two -o a.json --save-matrix a.npy");
  run_ok(kQuery + "--query one -o b.json --save-matrix b.npy");
  CHECK(file_json("a.json")["files"].contains("matrix"));
  const std::string eval = "vpr-eval a.json --ground-truth aligned --matrix ";
  run_ok(eval + "a.npy");
  check_unchanged(eval + "b.npy", 4, "is not the matrix that");
  run_ok(kQuery + "--query two -o a.json --force");  // it names no matrix
  CHECK(has(run_ok(eval + "a.npy").err, "no matrix was saved"));
}

TEST_CASE("a claimed number of frames costs no memory") {
  start_with(make_walks);
  run_ok(kTwo);
  Json result = file_json("r.json");
  result["sequences"][0]["frames"] = 2147483647;
  result["checksum"] = result_checksum(result);
  write_text("r.json", to_text(result));
  run_ok("vpr-eval r.json --html unknown.html");
  run_ok(
      "vpr-eval r.json --ground-truth aligned --html e.html --plot plots -o e.json "
      "--recognitions-csv e.csv");
  run_ok("vpr-eval convert aligned --result r.json --to pairs -o pairs.csv");
  rusage usage{};
  ::getrusage(RUSAGE_CHILDREN, &usage);  // the largest of all programs
  CHECK(usage.ru_maxrss < 1'000'000);    // kB, where a byte per claimed frame is 2 GB
}

TEST_CASE("an output never replaces an input of its run, not even with --force") {
  start_with(make_walks);
  run_ok(kTwo);
  const auto before = list_folder(".");
  CHECK(std::ranges::count(before, "r.npz") == 1);
  for (const std::string& name : before)
    if (name.starts_with("r.") || name == "gt.csv")
      check_unchanged("vpr-eval r.json --ground-truth gt.csv --force -o " + name, 2,
                      "is an input of this run");
  for (const std::string name : {"two/11.png", "d.vprdb/manifest.json"})
    check_unchanged(kQuery + "--query two --force -o " + name, 2, "is an input of this run");
  run_ok(kTwo + "--force");
  run_ok("vpr-train add d.vprdb --train two --force -o d.vprdb");
  CHECK(list_folder(".") == before);
  CHECK(read_text("gt.csv") == "query,ref\n3,3\n");
  write_text("dataset.json", R"({"schema": "vpr.dataset/3", "name": "w",
      "train": [{"name": "one", "sequence": "one"}],
      "queries": [{"name": "two", "sequence": "two",
                   "ground_truth": {"format": "pairs", "path": "gt.csv"}}]})");
  for (const std::string name : {"gt.csv", "two/10.png", "one/10.png"})
    check_unchanged(kQuery + "--dataset dataset.json --force -o " + name, 2,
                    "is an input of this run");
}

TEST_CASE("all outputs of an evaluation appear together, or none") {
  start_with(make_walks);
  run_ok(kTwo);
  // The page fails after the report was computed: the sequence is not the evaluated one.
  write_walk("short", 1, 0);
  const std::string eval = "vpr-eval r.json --ground-truth aligned -o e.json --html ";
  check_unchanged(eval + "e.html --query short", 2, "frames");
  for (const std::string other : {"e.json", "../", "./e.json"})
    check_unchanged(eval + other + " --force", 2, "");
}

TEST_CASE("outputs that cannot be written are detected before the work") {
  start_with(make_walks);
  check_unchanged(kQuery + "--query two -o " + std::string(251, 'x') + ".json", 3,
                  "can't be written");
  const std::string train = "vpr-train fastable --train one -o ";
  check_unchanged(train + std::string(256, 'x'), 3, "can't be written");
  run_ok(train + std::string(255, 'x'));
}
