// FAB-MAP's commands, and damage in the files of a database.

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "cli/world.h"
#include "fabmap/database.h"
#include "npz.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

const std::string kGrayImage = "P5\n32 32\n255\n" + std::string(1024, '\x80');

const std::string kTrain = "vpr-train fabmap --pretrain $other --features sift --words 60 ";

// Requires that two folders have the same files.
void check_same(const fs::path& one, const fs::path& other) {
  for (const std::string& name : list_folder(one)) {
    INFO(name);
    CHECK(read_text(one / name) == read_text(other / name));
  }
}

/// Writes the vocabulary, tree, and BOW matrices of the pretraining frames and places of a
/// database.
void write_openfabmap_files(const fs::path& path) {
  const FabmapDatabase database = read_fabmap_database(path);
  const size_t words = database.tree.words();
  const auto matrix = [&](const std::string& name, const ViewWords& views) {
    std::vector<uint8_t> values(views.views() * words);
    for (size_t v = 0; v < views.views(); ++v)
      for (const uint32_t word : views.view(v)) values[v * words + word] = 1;
    write_array<uint8_t>(name, values, {views.views(), words});
  };
  for (const std::string name : {"vocabulary.npy", "tree.npy"}) fs::copy_file(path / name, name);
  matrix("bow-pretrain.npy", database.pretrain);
  matrix("bow-train.npy", database.views);
}

// The bytes of a file after damage: cut, empty, and with another last bit.
Words damaged(const std::string& whole) {
  std::string bit = whole;
  bit.back() = static_cast<char>(bit.back() ^ 1);
  return {whole.substr(0, whole.size() / 2), "", bit};
}

}  // namespace

TEST_CASE("adding views yields the database of training all together") {
  run_ok(kTrain + "--train $one --train $back -o both.vprdb");
  run_ok("vpr-train add $fabmap --train $back -o added.vprdb");
  check_same("both.vprdb", "added.vprdb");
}

TEST_CASE("a database imported from vocabulary, tree and words has the same posteriors") {
  run_ok(kTrain + "--train $one --clustering radius --cluster-radius 300 -o r.vprdb");
  write_openfabmap_files("r.vprdb");
  run_ok(
      "vpr-train fabmap --from-openfabmap --features sift --vocabulary vocabulary.npy --tree "
      "tree.npy --pretrain bow-pretrain.npy --train bow-train.npy -o i.vprdb");
  for (const std::string name : {"r", "i"})
    run_ok("vpr-query " + name + ".vprdb --query $back --save-posteriors " + name + ".npy --json");
  CHECK(read_text("r.npy") == read_text("i.npy"));
}

TEST_CASE("frames without features keep their index and are counted, with a warning") {
  fs::create_directory("gray");
  for (const std::string name : {"1.pgm", "2.pgm"}) write_text("gray/" + name, kGrayImage);
  const std::string gray = "vpr-train fabmap --pretrain gray -o x.vprdb ";
  check_failure(gray + "--train $one", 2, "none of the 2 --pretrain frames has a surf feature");
  check_failure(gray + "--clustering radius", 2, "larger images, or another kind of --features");
  fs::copy(world().walk("one"), "walk");
  const auto frames = list_folder("walk").size();
  for (size_t i = 0; i < frames; ++i) write_text("walk/" + fmt::format("zz{}.pgm", i), kGrayImage);
  const auto query = run_ok("vpr-query $fabmap --query walk -o r.json");
  CHECK(has(query.err, "have no sift features"));
  CHECK(has(query.out, fmt::format("{} frames without features", frames)));
  CHECK(file_json("r.json")["query"]["featureless"] == frames);
  CHECK(npz_array<int32_t>("r.npz", "best").at(4 * frames + 1) == -1);
  const auto trained = run_ok(kTrain + "--train walk -o w.vprdb --json");
  CHECK(has(trained.err, "larger images"));
  CHECK(Json::parse(trained.out)["featureless_views"] == frames);
  CHECK(run_ok("vpr-query $fabmap --query $back --t-p 0.5 --json").err.empty());
}

TEST_CASE(
    "a query without recognitions states the highest probability, but suggests no smaller t_p") {
  const std::string words = "vpr-query $fabmap --query $back --t-p 0.9999 --speed 0.5";
  const auto nothing = run_ok(words);
  INFO(nothing.out);
  CHECK(has(nothing.out, "back, at speed 0.5"));
  CHECK(has(nothing.out, "no probability is above t_p 0.9999. The highest is 0."));
  CHECK_FALSE(has(nothing.out, "--t-p"));
  CHECK(run_ok(words + " --new-place-samples 2").out != nothing.out);  // of fewer frames
}

TEST_CASE("an undecodable frame never matches, as a view or in a loop") {
  fs::copy(world().walk("one"), "one");
  const std::string broken = list_folder("one")[3];
  write_text("one/" + broken, "broken");
  run_ok(kTrain + "--train one --skip-unreadable -o b.vprdb");
  fs::create_directory("gray");
  write_text("gray/1.pgm", kGrayImage);
  run_ok("vpr-query b.vprdb --query gray --save-posteriors p.npy -o r.json");
  const NpyArray posteriors("p.npy");
  const double floor = 0.01 / static_cast<double>(posteriors.shape()[1]);
  CHECK(posteriors.values<double>(2)[1 + 3] == Approx(floor));
  // A gray frame after the broken one, which resembles no other frame.
  fs::copy("gray/1.pgm", "one/zz.pgm");
  run_ok(kTrain + "-o v.vprdb");
  check_failure("vpr-query v.vprdb --query $one", 2, "vpr-query loops");
  run_ok("vpr-query loops v.vprdb --query one --skip-unreadable --t-p 0.5 -o l.json");
  const auto recognitions = npz_array<int32_t>("l.npz", "recognitions");
  for (size_t i = 0; i < recognitions.size(); i += 4) CHECK(recognitions[i + 3] != 3);
}

TEST_CASE("a FAB-MAP database does not depend on the instruction sets that OpenCV finds") {
  for (const std::string features : {"sift", "kaze", "akaze", "orb"}) {
    INFO(features);
    for (const std::string disabled :
         {"", "AVX2,AVX512-SKX", "SSE4.1,SSE4.2,FP16,AVX,AVX2,AVX512-SKX"}) {
      run_ok("vpr-train fabmap --pretrain $other@0:8 --words 20 --train $one@0:8 --features " +
                 features + " -o " + features + disabled,
             "OPENCV_CPU_DISABLE=" + disabled);
      check_same(features, features + disabled);
    }
  }
}

TEST_CASE("an undecodable pretraining frame is omitted and is not a frame without words") {
  fs::copy(world().walk("other"), "broken");
  write_text("broken/00001a.jpg", "broken");
  for (const std::string folder : {"$other", "broken"})
    run_ok("vpr-train fabmap --features orb --words 40 --train $one --skip-unreadable --pretrain " +
           folder + " -o " + (folder == "broken" ? "broken.vprdb" : "other.vprdb"));
  check_same("other.vprdb", "broken.vprdb");
}

TEST_CASE("damage in any file of a FAB-MAP database is detected") {
  fs::copy(world().fabmap(), "d.vprdb");
  const auto read = [] { read_database("d.vprdb"); };
  const auto words = "d.vprdb/places.npy";
  for (const std::string& name : list_folder("d.vprdb")) {
    INFO(name);
    const std::string file = "d.vprdb/" + name;
    const std::string whole = read_text(file);
    for (const std::string& text : damaged(whole)) {
      write_text(file, text);
      CHECK(error_kind(read) == ErrorKind::data);
      CHECK(has(error_text(read), "d.vprdb"));
    }
    fs::remove(file);
    const auto kind = error_kind(read);
    CHECK((kind == ErrorKind::input || kind == ErrorKind::data));
    write_text(file, whole);
  }
  write_text(words, damaged(read_text(words)).back());
  for (const std::string command : {"vpr-train info d.vprdb", "vpr-query d.vprdb --query $back"})
    check_failure(command, 4, "d.vprdb");
}

TEST_CASE("FAB-MAP with places and FastABLE with frames are compared query by query") {
  const std::string walk = world().walk("one");
  const size_t frames = images_of(walk).size();
  const size_t half = frames / 2;
  run_ok(kTrain +
         fmt::format("--place a={0}@0:{1} --place b={0}@{1}:{2} -o p.vprdb", walk, half, frames));
  run_ok("vpr-train fastable --train $one --c-l 4 -o s.vprdb");
  run_ok("vpr-query p.vprdb --query $one -o p.json");
  run_ok("vpr-query s.vprdb --query $one --c-l 4 --t-r 0.3 -o s.json");
  const Json result = file_json("p.json");
  CHECK(result["sequences"][0]["frames"] == 2);
  CHECK(result["places"]["names"] == Json{"a", "b"});
  CHECK(result["places"]["views"] == frames);
  // Frames of the last place without a label in the ground truth of places.
  const auto compare = [&](size_t unknown) {
    std::string pairs = "query,reference\n";
    for (size_t frame = 0; frame + unknown < frames; ++frame)
      pairs += fmt::format("{},{}\n", frame, frame < half ? 0 : 1);
    write_text("places.csv", pairs);
    run_ok("vpr-eval p.json --ground-truth places.csv --force -o p-report.json");
    run_ok("vpr-eval s.json --ground-truth aligned --force -o s-report.json");
    const auto outcome = run_ok("vpr-eval compare p-report.json s-report.json --json");
    CHECK(has(outcome.err, "places and frames have different ground truths"));
    return Json::parse(outcome.out);
  };
  const Json all = compare(0);
  CHECK(all["ground_truths"] == "of-places-and-frames");
  CHECK(all["frames"]["compared"] == frames);
  CHECK(all["frames"]["with_match"] == frames);
  CHECK(all["frames"]["disputed"] == 0);
  // A sequence against itself: FAB-MAP has every frame correct, windows those at which one ends.
  CHECK(all["metrics"][0]["value"] == 1);
  CHECK(all["metrics"][1]["metric"] == "recall_at_1");
  CHECK(all["metrics"][1]["value"].get<double>() ==
        Approx(static_cast<double>(frames - 3) / static_cast<double>(frames)));
  const Json fewer = compare(5);
  CHECK(fewer["frames"]["compared"] == frames - 5);
  CHECK(fewer["frames"]["disputed"] == 5);
}
