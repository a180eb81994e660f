// --fps and --speed: the selected and resampled frames, and their evaluation.
#include <algorithm>

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include "cli/world.h"
#include "npz.h"
#include "recordings/sequence.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

const std::string kReplay = "vpr-query $db --t-r 0.3 ";

// The query "back" with single frames, so that results do not depend on neighboring frames.
RunOutcome single(const std::string& output, const std::string& more = "") {
  return run_ok(kReplay + "--query $back --c-l 1 -o " + output + " " + more);
}

Json evaluation_of(const std::string& result) {
  return printed_json("vpr-eval " + result + " --ground-truth $truth --json");
}

// The selected frames and the best matches of a result.
std::string bytes_of(const std::string& name) {
  return npz_bytes(name + ".npz", "source_frames") + npz_bytes(name + ".npz", "best");
}

std::string outcomes(const Json& report) { return report["outcomes"]["best"].get<std::string>(); }

}  // namespace

TEST_CASE(
    "a resampled query has the results of the query frame by frame, with the same ground truth") {
  single("plain.json");
  const Json plain = evaluation_of("plain.json");
  const std::string expected = outcomes(plain);
  single("thin.json", "--recorded-fps 30 --fps 10");
  const Json thin = evaluation_of("thin.json");
  std::string kept;
  for (size_t i = 0; i < expected.size(); i += 3) kept += expected[i];
  CHECK(outcomes(thin) == kept);
  CHECK(thin["resampled"] == Json{{"fps", 10.0}, {"frames", expected.size()}});
  CHECK(has(thin["protocol"]["ground_truth"], ", query resampled to 10 frames per second"));
  const Json result = file_json("thin.json");
  CHECK(result["query"]["fps"] == 10.0);
  CHECK(result["query"]["frames"] == kept.size());
  CHECK(npz_array<int32_t>("thin.npz", "source_frames")[2] == 6);
  // Thinned, and then resampled.
  const auto both = single("both.json", "--recorded-fps 30 --fps 10 --speed reversed");
  CHECK(has(both.out, "back, resampled to 10 frames per second, at speed reversed"));
  CHECK(outcomes(evaluation_of("both.json")) == std::string(kept.rbegin(), kept.rend()));
  // The recording's own rate selects all frames.
  single("same.json", "--recorded-fps 30 --fps 30");
  CHECK(outcomes(evaluation_of("same.json")) == expected);
  CHECK_FALSE(file_json("same.json")["query"].contains("resampled"));
}

TEST_CASE("names, lists and constant rates select the same frames, live or not") {
  const std::string walk = world().walk("back");
  const Words images = images_of(walk);
  fs::create_directory("named");
  std::string times = "time\n";
  for (size_t i = 0; i < images.size(); ++i) {
    fs::create_symlink(walk + "/" + images[i],
                       fmt::format("named/{}.{}00.png", 1305031102 + i / 10, i % 10));
    times += fmt::format("{}.{}\n", 70 + i / 10, i % 10);
  }
  write_text("times.csv", times);
  const auto at_four = [&](const std::string& name, const std::string& more) {
    run_ok(kReplay + "--c-l 2 --fps 4 -o " + name + ".json " + more);
    return bytes_of(name);
  };
  const std::string even = at_four("even", "--query $back --recorded-fps 10");
  CHECK(at_four("named", "--query named") == even);
  CHECK(at_four("list", "--query $back --query-times times.csv") == even);
  std::string list;
  for (const std::string& name : images_of("named")) list += "named/" + name + "\n";
  write_text("list.txt", list);
  CHECK(at_four("list2", "--query list.txt") == even);
  const std::string live =
      "vpr-query live $db --c-l 2 --t-r 200 --t-r-scale bits --fps 4 --quiet --query ";
  const auto followed = run_ok(live + "list.txt");
  CHECK(lines_of(followed.out).size() == npz_array<int32_t>("even.npz", "source_frames").size());
  CHECK(has(followed.out, "\"1305031102.200.png\""));
  CHECK_FALSE(has(followed.out, "\"1305031102.100.png\""));
}

TEST_CASE("resampled training frames keep the ground truth of the recordings") {
  const auto trained =
      run_ok("vpr-train fastable --train $one --c-l 2 --recorded-fps 12 --fps 4 -o thin.vprdb");
  const size_t recorded = images_of(world().walk("one")).size();
  const size_t kept = (recorded + 2) / 3;
  CHECK(has(trained.out, fmt::format("{} of {}", kept, recorded)));
  const Json sequence = printed_json("vpr-train info thin.vprdb --json")["sequences"][0];
  CHECK(sequence["fps"] == 4.0);
  CHECK(sequence["resampled"] == Json{{"fps", 4.0}, {"frames", recorded}});
  // A sequence against itself: frame i matches frame i of the recording, and the nearest selected
  // one.
  run_ok("vpr-query thin.vprdb --t-r 0.3 --query $one --c-l 1 -o r.json");
  const Json report = printed_json("vpr-eval r.json --ground-truth aligned --json");
  CHECK(
      has(report["protocol"]["ground_truth"], "training frames resampled to 4 frames per second"));
  CHECK(report["best_match"]["without_match"] == 0);
  const std::string best = outcomes(report);
  for (size_t i = 0; i < best.size(); i += 3) CHECK(best[i] == 'c');

  // A tolerance counts recorded frames, so none is proposed, and none is plotted over selected
  // ones.
  std::string far = "query,reference\n";
  for (size_t i = 0; i + 5 < recorded; ++i) far += fmt::format("{},{}\n", i, i + 5);
  write_text("far.csv", far);
  const auto wrong =
      run_ok("vpr-eval r.json --ground-truth far.csv --tolerance 1 -o wrong.json --plot plots");
  CHECK_FALSE(has(wrong.err, "use --tolerance"));
  CHECK(read_json("wrong.json", ErrorKind::data)["protocol"]["tolerance_frames"] == 1);
  CHECK_FALSE(std::filesystem::exists("plots/recall-tolerance.svg"));
}

TEST_CASE("two different rates cause a warning, unless the method estimates them") {
  run_ok("vpr-train fastable --train $one --c-l 5 --recorded-fps 8 -o w.vprdb");
  const auto warned = [&](const std::string& more) {
    return run_ok("vpr-query w.vprdb --query $back --c-l 5 --t-r 0.5 --json " + more).err;
  };
  CHECK(has(warned("--recorded-fps 24"),
            "the query has 24 frames per second, the training sequence one has 8"));
  CHECK(has(warned("--recorded-fps 16"), "--fps 8 for the query, or --method filter"));
  CHECK(has(warned("--recorded-fps 4"), "--fps 4 for vpr-train"));
  for (const std::string equal : {"--recorded-fps 24 --fps 8", "--recorded-fps 8.5", ""})
    CHECK_FALSE(has(warned(equal), "frames per second"));
  const std::string filter = "vpr-query w.vprdb --query $back --method filter --recorded-fps ";
  CHECK(has(run(filter + "24").err, "the filter needs half to twice as many. Use --fps 8"));
  CHECK_FALSE(has(run(filter + "16").err, "frames per second"));
}

TEST_CASE("a query at a simulated speed has the results of the recorded frames") {
  single("plain.json");
  const std::string expected = outcomes(evaluation_of("plain.json"));
  const auto varying = single("v.json", "--speed varying --seed 7");
  CHECK(has(varying.out, "back, at speed varying, seed 7"));
  const Json report = evaluation_of("v.json");
  CHECK(report["speed"] == Json{{"name", "varying"}, {"seed", 7}, {"frames", expected.size()}});
  CHECK(has(report["protocol"]["ground_truth"], "query at speed "));
  std::string replayed;
  for (const uint32_t source : at_speed("varying", expected.size(), 7).sources)
    replayed += expected[source];
  CHECK(outcomes(report) == replayed);
  single("other.json", "--speed varying --seed 2");
  CHECK(bytes_of("other") != bytes_of("v"));
}

TEST_CASE(
    "scores of a resampled query are evaluated like its result, and a sweep counts the same") {
  single("r.json", "--speed stops --seed 5 --only-sequence one --save-matrix d.npy");
  const Json report = printed_json("vpr-eval r.json --ground-truth aligned --tolerance 9 --json");
  const std::string frames = report["speed"]["frames"].dump();
  const auto judge = [&](const std::string& more) {
    return run("vpr-eval matrix d.npy --distance --json --ground-truth aligned --tolerance 9 " +
               more);
  };
  const Json scores = printed_json(judge("--speed stops --seed 5 --query-frames " + frames));
  CHECK(outcomes(scores) == outcomes(report));
  CHECK(scores["speed"] == report["speed"]);
  check_failure(judge("--speed stops --seed 6 --query-frames " + frames), 4, "Use the speed");
  check_failure(judge("--query-frames " + frames), 4, "need a query of 64 frames");

  const Json sweep = printed_json(
      "vpr-tune fastable $db --dataset $dataset --c-l 1,4 --t-r 0.2,0.3 --speed varying --json");
  CHECK(sweep["queries"][0]["speed"]["name"] == "varying");
  single("v.json", "--speed varying");
  const Json counts = evaluation_of("v.json");
  CHECK(sweep["cells"][1]["counts"] == counts["counts"]);
  CHECK(sweep["cells"][1]["best_match"]["correct"] == counts["best_match"]["correct"]);
}

TEST_CASE("images and maps of a resampled query show the frames of the query") {
  single("r.json", "--speed reversed");
  run_ok("vpr-eval r.json --dataset $dataset --html r.html --map map");
  const std::string page = read_text("r.html");
  const size_t frames = file_json("r.json")["query"]["frames"].get<size_t>();
  // A card's caption names the frame of the query, and the file that it shows.
  size_t captions = 0;
  for (size_t at = page.find("<figcaption>query "); at != std::string::npos;
       at = page.find("<figcaption>query ", at + 1)) {
    const size_t frame = std::stoul(page.substr(at + 18));
    const size_t name = page.find(": ", at) + 2;
    CHECK(std::stoul(page.substr(name)) == frames - 1 - frame);
    ++captions;
  }
  CHECK(captions > 0);
  CHECK(list_folder("map").size() > 1);
}

TEST_CASE("a single frame is selected at any rate and speed") {
  for (const std::string flags : {"--fps 4 --recorded-fps 30", "--speed stops"}) {
    run_ok(kReplay + "--c-l 1 --force -o r.json --query $back@0:1 " + flags);
    CHECK(file_json("r.json")["query"]["frames"] == 1);
  }
}
