// Advice if a query recognizes nothing, or everything.
#include "query/advice.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "examples.h"
#include "queries.h"
#include "query/prepare.h"
#include "query/train_sequences.h"
#include "support.h"

using namespace vpr;
using test::has;

namespace {

// Twenty query windows and ten training windows.
Result planned_result(std::optional<double> threshold) {
  Result result;
  result.settings = test::by_threshold(2, threshold);
  result.query_windows = 20;
  ComparedSequence& sequence = result.sequences.emplace_back();
  sequence.sequence.name = "walk";
  sequence.windows = 10;
  sequence.threshold = threshold;
  for (uint32_t j = 0; j < 20; ++j) result.best.emplace_back(Match{j, 0, 3, 0, 100 + 10.0 * j});
  return result;
}

// The advice for frames first, first + step, ... of a sequence of 160.
std::string finding(const test::Example& walk, size_t first, size_t step) {
  std::vector<LdbCode> frames;
  for (size_t f = first; f < walk.train[0].size(); f += step) frames.push_back(walk.train[0][f]);
  SequenceDatabase database = test::make_database({walk.train[0]});
  ensure_statistics(database, {});
  return filter_advice(database, test::make_query(frames), {}, {}, {});
}

}  // namespace

TEST_CASE("more than a fifth of the pairs of a sequence as recognitions is too many") {
  Result result = planned_result(200);
  for (uint32_t j = 0; j < 20; ++j)
    for (uint32_t i = 0; i < 2; ++i) result.recognitions.push_back({j, 0, i, 0, 300});
  CHECK_FALSE(excess_advice(result));  // 40 of 200
  result.recognitions.push_back({19, 0, 2, 0, 300});
  CHECK(excess_advice(result) ==
        "t_r accepts 20 % of the window pairs of walk: too many to tell places apart");
  CHECK(recognized_windows(result) == 20);
  result.sequences.insert(result.sequences.begin(), 2, result.sequences[0]);  // of other places
  for (Match& recognition : result.recognitions) recognition.sequence = 2;
  CHECK(excess_advice(result) ==
        "t_r accepts 20 % of the window pairs of walk: too many to tell places apart");
  for (uint32_t j = 0; j < 20; ++j)
    for (uint32_t i = 0; i < 10; ++i) result.recognitions.push_back({j, 0, i, 0, 300});
  result.sequences[0].sequence.name = "stairs";
  CHECK(excess_advice(result) ==
        "t_r accepts 100 % of the window pairs of stairs, and more than a fifth of 1 other "
        "training sequence: too many to tell places apart");
  CHECK_FALSE(excess_advice(Result{}));
}

TEST_CASE("without a threshold, no match is reported as too far") {
  CHECK(has(no_recognition_advice(planned_result(10)), "no score is below t_r"));
  CHECK(no_recognition_advice(planned_result(std::nullopt)) ==
        "Best matches only: a recognition needs --t-r, or --decide margin with --margin.");
  Result by_margin = planned_result(std::nullopt);
  by_margin.settings = test::by_margin(2);
  CHECK(has(no_recognition_advice(by_margin), "--exclusion-frames"));
  by_margin.margins.assign(20, 5.0);
  CHECK(has(no_recognition_advice(by_margin), "no best match has the margin"));
}

TEST_CASE("the filter distinguishes another speed from another place") {
  const test::Example walk = test::make_example({160}, 0, 3);
  CHECK(has(finding(walk, 0, 1), "With default settings (--method filter, margin 14), 1"));
  const std::string twice = finding(walk, 0, 2);
  INFO(twice);
  CHECK(has(twice, " of 80 frames are recognized, at about 2.0 times the speed."));
  SequenceDatabase database = test::make_database({walk.train[0]});
  ensure_statistics(database, {});
  const test::Example other = test::make_example({1}, 100, 4);
  const DescriptorSet elsewhere = test::make_query(other.query);
  CHECK(
      filter_advice(database, elsewhere, {}, {}, {}) ==
      "Nothing matches: not forward, not backward, not at half or twice the speed, not with fewer "
      "frames of both sides. The query may show another place, or the 28 keyframes of the query "
      "are too few: a decision needs up to 64.");
  CHECK(has(finding(walk, 0, 16), "The query has 10 keyframes"));
  CHECK(has(filter_advice(database, test::make_query(walk.train[0]), {Filter{64}}, {}, {}),
            "With default settings (--method filter, margin 14), 1"));
}

TEST_CASE("a filter that recognizes two thirds of the frames needs no advice") {
  Result result;
  result.path.emplace();
  result.query.frames = 9;
  for (uint32_t j = 0; j < 5; ++j) result.recognitions.push_back({j, 0, j, 0, 100});
  CHECK(needs_advice(result));
  result.recognitions.push_back({5, 0, 5, 0, 100});
  CHECK_FALSE(needs_advice(result));
}

TEST_CASE("a filter with few keyframes that recognizes less than nine tenths needs advice") {
  Result result;
  result.settings = SequenceQuerySettings{Filter{}};
  result.path.emplace();
  result.query.frames = 20;
  for (uint32_t j = 0; j < 17; ++j) result.recognitions.push_back({j, 0, j, 0, 100});
  CHECK_FALSE(needs_advice(result));  // keyframes are not counted
  result.path->keyframes = 16;
  CHECK_FALSE(needs_advice(result));
  result.path->keyframes = 15;
  CHECK(needs_advice(result));
  result.settings = SequenceQuerySettings{Filter{64}};
  CHECK_FALSE(needs_advice(result));
  result.settings = SequenceQuerySettings{Filter{}};
  result.recognitions.push_back({17, 0, 17, 0, 100});
  CHECK_FALSE(needs_advice(result));
}

TEST_CASE("advice does not repeat a query with default settings that recognizes its part") {
  const test::Example walk = test::make_example({160}, 0, 3);
  const test::Example other = test::make_example({100}, 0, 9);
  std::vector<LdbCode> frames(walk.train[0].begin(), walk.train[0].begin() + 80);
  frames.insert(frames.end(), other.train[0].begin(), other.train[0].end());
  SequenceDatabase database = test::make_database({walk.train[0]});
  ensure_statistics(database, {});
  const DescriptorSet query = test::make_query(frames);
  const PreparedDatabase prepared = prepare(database, {Filter{}});
  const Result known =
      run_query(plan_query(prepared, query, "", {Filter{}}, {}, {}), {}, {}).result;
  CHECK(filter_advice(database, query, {Filter{}}, {}, {}, &known).empty());
  CHECK(has(filter_advice(database, query, {Filter{64}}, {}, {}), " of 180 frames are recognized"));
}

TEST_CASE("images that show more than those of the other sequence are named") {
  const test::TemporaryFolder folder;
  const std::filesystem::path laps = test::source_path("data/example");
  // The middle of the images of a lap.
  const auto middle = [&](const std::string& lap, double share) {
    const std::string name = fmt::format("{} {}", lap, share);
    std::filesystem::create_directory(folder / name);
    for (const auto& file : std::filesystem::directory_iterator(laps / lap)) {
      const cv::Mat image = cv::imread(file.path().string(), cv::IMREAD_GRAYSCALE);
      const int width = cvRound(share * image.cols);
      const int height = cvRound(share * image.rows);
      const cv::Rect part((image.cols - width) / 2, (image.rows - height) / 2, width, height);
      cv::imwrite((folder / name / file.path().stem().string()).string() + ".png", image(part));
    }
    return folder / name;
  };
  const auto found = [](const std::filesystem::path& train, const std::filesystem::path& walk) {
    SequenceDatabase database = train_sequences({{"train", {train, {}}}}, {}, {});
    const SequenceArgument images{walk, {}};
    const DescriptorSet query = describe_frames(open_sequence(images), database, false, {});
    return filter_advice(database, query, {Filter{}}, {}, {}, nullptr, &images);
  };
  CHECK(found(laps / "monday", middle("tuesday", 0.7))
            .starts_with("With the middle 80 % of the training images, "));
  CHECK(has(found(middle("monday", 0.5), laps / "tuesday"),
            " of 40 frames are recognized: they show more than the training images. Crop them, or "
            "use the same lens and zoom."));
}

TEST_CASE("interpolated frames on both sides are named, with the step from the recording") {
  constexpr int kBlended = 18;  // frames per image
  const test::TemporaryFolder folder;
  const auto interpolated = [&](const std::string& lap) {
    std::vector<std::filesystem::path> files;
    for (const auto& file :
         std::filesystem::directory_iterator(test::source_path("data/example") / lap))
      files.push_back(file.path());
    std::ranges::sort(files);
    std::filesystem::create_directory(folder / lap);
    cv::Mat last;
    size_t frame = 0;
    for (const auto& file : files) {
      const cv::Mat next = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
      for (int k = 0; k < kBlended && !last.empty(); ++k, ++frame) {
        cv::Mat blended;
        cv::addWeighted(last, 1 - k / double{kBlended}, next, k / double{kBlended}, 0, blended);
        cv::imwrite((folder / lap / fmt::format("{:04}.png", frame)).string(), blended);
      }
      last = next;
    }
    return folder / lap;
  };
  const std::filesystem::path monday = interpolated("monday");
  const std::filesystem::path tuesday = interpolated("tuesday");
  const FrameRange range{0, {}, 2};
  SequenceDatabase database = train_sequences({{"monday", {monday, range}}}, {}, {});
  const SequenceArgument images{tuesday, range};
  const DescriptorSet query = describe_frames(open_sequence(images), database, false, {});
  const PreparedDatabase prepared = prepare(database, {Filter{}});
  const Result known =
      run_query(plan_query(prepared, query, "", {Filter{}}, {}, {}), {}, {}).result;
  CHECK(3 * recognized_windows(known) > 2 * known.query.frames);
  CHECK(needs_advice(known));
  const std::string advice = filter_advice(database, query, {Filter{}}, {}, {}, &known, &images);
  INFO(advice);
  CHECK(advice.starts_with("With every third frame of both sides, "));
  CHECK(has(advice, " of 117 frames are recognized"));
  CHECK(has(advice, "Train with PATH@::6, and query PATH@::6."));
}

TEST_CASE("without a match of any window, none is compared with a limit") {
  Result result = planned_result(10);
  CHECK(has(no_recognition_advice(result), "below t_r"));
  result.best.assign(20, std::nullopt);
  CHECK(no_recognition_advice(result) ==
        "No window has a match: none has an earlier readable window beyond --gap.");
}
