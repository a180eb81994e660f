// Local features as a second witness of the filter's paths.
#include "query/witness.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "base/parallel.h"
#include "base/random.h"
#include "query/live_lines.h"
#include "query/sequence_query.h"
#include "recordings/frames.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;

namespace {

std::vector<LocalFeature> random_features(size_t count, uint64_t seed) {
  RandomEngine engine = named_engine(seed, "features");
  std::vector<LocalFeature> features(count);
  for (LocalFeature& feature : features) {
    for (uint8_t& byte : feature.bits) byte = static_cast<uint8_t>(uniform_below(engine, 256));
    feature.x = static_cast<float>(uniform_below(engine, 400));
    feature.y = static_cast<float>(uniform_below(engine, 300));
  }
  return features;
}

// The features after a rotation, a change of scale and a shift.
std::vector<LocalFeature> moved(std::vector<LocalFeature> features, double degrees, double scale) {
  const double angle = degrees * std::acos(-1.0) / 180;
  for (LocalFeature& feature : features) {
    const double x = feature.x;
    const double y = feature.y;
    feature.x = static_cast<float>(scale * (std::cos(angle) * x - std::sin(angle) * y) + 7);
    feature.y = static_cast<float>(scale * (std::sin(angle) * x + std::cos(angle) * y) - 9);
  }
  return features;
}

// Frames along a wall with a random pattern.
void write_wall(const std::string& folder, size_t frames, int shift) {
  std::filesystem::create_directories(folder);
  RandomEngine engine(5);
  cv::Mat pattern(20, 160, CV_8U);
  for (int y = 0; y < pattern.rows; ++y)
    for (int x = 0; x < pattern.cols; ++x)
      pattern.at<uint8_t>(y, x) = static_cast<uint8_t>(uniform_below(engine, 256));
  cv::Mat wall;
  cv::resize(pattern, wall, {}, 10, 10, cv::INTER_CUBIC);
  for (size_t i = 0; i < frames; ++i) {
    const cv::Mat view = wall(cv::Rect(shift + 16 * static_cast<int>(i), shift / 2, 240, 180));
    cv::imwrite(folder + "/" + std::to_string(100 + i) + ".png", view);
  }
}

}  // namespace

TEST_CASE("inliers are features that one similarity transform maps to their matches") {
  const std::vector<LocalFeature> features = random_features(60, 1);
  CHECK(inliers(features, features).size() == 60);
  for (const PointPair& pair : inliers(features, features)) CHECK(pair.query == pair.train);
  CHECK(inliers(features, moved(features, 10, 1.5)).size() == 60);
  CHECK(inliers(features, moved(features, 0, 0.6)).size() == 60);
  CHECK(inliers(features, moved(features, 40, 1)).size() <= 5);
  CHECK(inliers(features, moved(features, 0, 2.5)).size() <= 5);
  CHECK(inliers(features, random_features(60, 2)).size() <= 2);

  std::vector<LocalFeature> mixed = moved(features, 5, 1);
  for (size_t i = 0; i < 30; ++i) mixed[i].x = static_cast<float>(13 * i % 400);
  const size_t half = inliers(features, mixed).size();
  CHECK(half >= 30);
  CHECK(half <= 36);
}

TEST_CASE("few features have no inliers") {
  const std::vector<LocalFeature> features = random_features(3, 1);
  CHECK(inliers({}, features).empty());
  CHECK(inliers(features, {}).empty());
  CHECK(inliers(std::span(features).first(1), features).empty());
  CHECK(find_local_features(cv::Mat(31, 64, CV_8U, cv::Scalar(0))).empty());
  CHECK(find_local_features(cv::Mat(200, 200, CV_8U, cv::Scalar(99))).empty());
}

TEST_CASE("features are found in images with a longer side near 320 pixels") {
  const auto side = [](int width, int height) {
    const cv::Mat working = working_image(cv::Mat(height, width, CV_8U, cv::Scalar(0)));
    return std::max(working.cols, working.rows);
  };
  CHECK(side(64, 32) == 64);
  CHECK(side(479, 100) == 479);
  CHECK(side(480, 100) == 240);
  CHECK(side(1920, 1080) == 320);
}

TEST_CASE("a keyframe stands for the frames up to the next one") {
  const std::vector<LocalFeature> features = random_features(3, 1);
  KeyframeFeatures found;
  found.append(1, std::span(features).first(1));
  found.append(4, std::span(features).first(2));
  CHECK(found.count_until(0) == 0);
  CHECK(found.count_until(1) == 1);
  CHECK(found.count_until(3) == 1);
  CHECK(found.count_until(9) == 2);
  CHECK(found.of(1).size() == 2);
}

TEST_CASE("frames are chosen that differ enough from the last chosen one") {
  const auto choices = [](const std::optional<TrainStatistics>& statistics) {
    const FeatureChoice choose = choose_changes(ElementType::bits, statistics);
    std::vector<bool> chosen;
    for (const int bits : {0, 1, 3, 4, 8, 8, 9}) {
      std::vector<uint8_t> row(8);
      for (int bit = 0; bit < bits; ++bit) row[static_cast<size_t>(bit / 8)] |= 1 << (bit % 8);
      chosen.push_back(choose(row));
    }
    return chosen;
  };
  TrainStatistics statistics;
  statistics.typical_distance = 4;  // 1.6 bits
  CHECK(choices(statistics) == std::vector<bool>{true, false, true, false, true, false, false});
  CHECK(choices({}) == std::vector<bool>{true, true, true, true, true, false, true});
}

TEST_CASE("clear contrast adds to a margin, and absence subtracts from it where features can see") {
  CHECK(evidence_margin(1.3, 1) == std::llround(3.6 * kScoreUnit));
  CHECK(evidence_margin(9, 0) == 9 * int64_t{kScoreUnit});
  CHECK(evidence_margin(1.2, 1) == 0);
  CHECK(evidence_margin(0.75, 1) == 0);
  CHECK(evidence_margin(0.65, 1) == -7 * int64_t{kScoreUnit});
  CHECK(evidence_margin(-1, 0.5) == -14 * int64_t{kScoreUnit});
  CHECK(evidence_margin(-1, 0.49) == 0);
}

TEST_CASE("a witness recognizes more frames, and frame by frame the same ones") {
  write_wall("train", 80, 0);
  write_wall("query", 60, 6);
  SequenceTrainSettings training;
  training.features = Witness::orb;
  const auto database = std::make_shared<SequenceDatabase>(
      train_sequences({{"train", parse_sequence_argument("train")}}, training, {}));
  REQUIRE(database->features);
  CHECK(database->features->frames.size() == database->features->ends.size());
  {
    const ThreadLimit one(1);
    const SequenceDatabase again =
        train_sequences({{"train", parse_sequence_argument("train")}}, training, {});
    CHECK(again.features->frames == database->features->frames);
    CHECK(std::ranges::equal(bits_of(again.features->all).bytes,
                             bits_of(database->features->all).bytes));
  }

  const auto result_of = [&](Witness witness) {
    Filter rule;
    rule.witness = witness;
    const SequenceQuerySettings settings{rule};
    ResultContext context;
    const QueryData data =
        open_query({{"query", parse_sequence_argument("query")}, database}, settings, context, {});
    return run_query(data, settings, {}, {}, context, {}).result;
  };
  const Result alone = result_of(Witness::none);
  const Result whole = result_of(Witness::orb);
  CHECK(alone.path->witnessed.empty());
  REQUIRE(whole.path->witnessed.size() == 60);
  CHECK(whole.best == alone.best);
  CHECK(whole.recognitions.size() >= alone.recognitions.size());
  REQUIRE(!whole.recognitions.empty());
  const auto& decided = whole.path->witnessed[whole.recognitions.front().query];
  REQUIRE(decided);
  CHECK(decided->contrast.value_or(0) > 1.2);

  Filter rule;
  rule.witness = Witness::orb;
  LiveLines lines(*database, "query", {rule}, {}, {});
  std::vector<Match> live;
  const auto add = [&](const std::optional<LiveAnswer>& answer) {
    if (answer) live.insert(live.end(), answer->recognized.begin(), answer->recognized.end());
  };
  for (const std::string& name : list_folder("query")) {
    LiveFrame frame;
    frame.name = name;
    frame.file = "query/" + name;
    add(lines.take(frame, {}));
  }
  add(lines.finish());
  CHECK(live == whole.recognitions);
}
