#include "matching/distance_statistics.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "matching/bit_counts.h"
#include "matching/plain.h"
#include "matching/standardization.h"
#include "support.h"

using namespace vpr;

namespace {

// By the definition, in double precision.
TrainStatistics plain_statistics(std::span<const CodeSpan> sequences, size_t reach) {
  struct Frame {
    size_t sequence;
    size_t index;
    LdbCode code;
    bool readable;
  };
  std::vector<Frame> frames;
  for (size_t s = 0; s < sequences.size(); ++s)
    for (size_t i = 0; i < sequences[s].codes.size(); ++i) {
      const auto& bad = sequences[s].unreadable;
      frames.push_back(
          {s, i, sequences[s].codes[i], std::find(bad.begin(), bad.end(), i) == bad.end()});
    }
  std::vector<double> means;
  std::vector<double> variances;
  double total = 0;
  size_t known = 0;
  for (const Frame& frame : frames) {
    std::vector<double> distances;
    for (const Frame& other : frames)
      if (other.readable &&
          (other.sequence != frame.sequence ||
           std::max(other.index, frame.index) - std::min(other.index, frame.index) > reach))
        distances.push_back(plain_hamming(frame.code, other.code));
    double sum = 0;
    for (const double d : distances) sum += d;
    const double mean = sum / static_cast<double>(distances.size());
    double spread = 0;
    for (const double d : distances) spread += (d - mean) * (d - mean);
    means.push_back(frame.readable ? mean : std::nan(""));
    variances.push_back(spread / static_cast<double>(distances.size()));
    if (frame.readable) total += mean;
    if (frame.readable) ++known;
  }
  TrainStatistics statistics;
  statistics.typical_distance = total / static_cast<double>(known);
  for (size_t i = 0; i < frames.size(); ++i) {
    statistics.bias.push_back(static_cast<float>(means[i] - statistics.typical_distance));
    statistics.variance.push_back(static_cast<float>(variances[i]));
  }
  return statistics;
}

}  // namespace

TEST_CASE("statistics of training frames are those of the definition") {
  const std::vector<LdbCode> one = test::walk_codes(300, 1);
  const std::vector<LdbCode> two = test::walk_codes(90, 2);
  const std::vector<size_t> unreadable = {0, 150};
  const std::vector<CodeSpan> spans = {{one, unreadable}, {two, {}}};
  StatisticsSettings settings;
  settings.neighbour_share = 0.02;  // 6 of 300 frames, 5 (neighbour_frames) of 90
  settings.neighbour_frames = 6;
  const TrainStatistics expected = plain_statistics(spans, 6);
  for (const HammingKernels& kernels : test::all_kernels()) {
    const TrainStatistics found =
        compute_statistics(make_train_codes(spans), settings, kernels, {});
    CHECK(found.typical_distance == Approx(expected.typical_distance).epsilon(1e-12));
    REQUIRE(found.bias.size() == 390);
    for (size_t i = 0; i < 390; ++i) {
      if (i == 0 || i == 150) {
        CHECK(found.bias[i] == 0);
        continue;
      }
      REQUIRE(found.bias[i] == Approx(expected.bias[i]).margin(1e-4));
      REQUIRE(found.variance[i] == Approx(expected.variance[i]).epsilon(1e-5));
    }
  }
}

TEST_CASE("the reach of neighbours grows with the sequence") {
  const std::vector<LdbCode> codes = test::walk_codes(500, 3);
  const CodeSpan span{codes, {}};
  const TrainCodes train = make_train_codes(std::span(&span, 1));
  const TrainStatistics expected = plain_statistics(std::span(&span, 1), 10);
  const TrainStatistics found = compute_statistics(train, {}, select_kernels(), {});
  for (size_t i = 0; i < 500; ++i) REQUIRE(found.bias[i] == Approx(expected.bias[i]).margin(1e-4));
}

TEST_CASE("long training data are sampled, the same for the same seed") {
  const std::vector<LdbCode> codes = test::walk_codes(3000, 4);
  const CodeSpan span{codes, {}};
  const TrainCodes train = make_train_codes(std::span(&span, 1));
  StatisticsSettings settings;
  settings.samples = 500;
  const std::vector<size_t> frames = sampled_frames(train, settings);
  CHECK(frames.size() == 500);
  CHECK(std::is_sorted(frames.begin(), frames.end()));
  CHECK(std::adjacent_find(frames.begin(), frames.end()) == frames.end());
  CHECK(sampled_frames(train, settings) == frames);
  const TrainStatistics all = compute_statistics(train, {}, select_kernels(), {});
  const TrainStatistics some = compute_statistics(train, settings, select_kernels(), {});
  CHECK(some == compute_statistics(train, settings, select_kernels(), {}));
  for (size_t i = 0; i < 3000; ++i)
    REQUIRE(std::abs(some.bias[i] - all.bias[i]) < 5);  // a tenth of a deviation
  settings.seed = 2;
  CHECK(sampled_frames(train, settings) != frames);
}

TEST_CASE("training data too short to tell have no bias") {
  for (const size_t count : {1, 3, 6}) {
    const std::vector<LdbCode> codes = test::walk_codes(count, 5);
    const CodeSpan span{codes, {}};
    const TrainStatistics found =
        compute_statistics(make_train_codes(std::span(&span, 1)), {}, select_kernels(), {});
    CHECK(found.typical_distance == kUnknownDistance);
    for (size_t i = 0; i < count; ++i) {
      CHECK(found.bias[i] == 0);
      CHECK(found.variance[i] == kUnknownDeviation * kUnknownDeviation);
    }
  }
}

TEST_CASE("settings of the statistics out of range are refused") {
  const auto refused = [](const StatisticsSettings& settings) {
    return test::error_kind([&] { compute_statistics({}, settings, select_kernels(), {}); }) ==
           ErrorKind::usage;
  };
  CHECK(refused({5, 0.02, 0, 1}));
  CHECK(refused({5, 0.02, 2'000'000, 1}));
  CHECK(refused({5, -0.1, 100, 1}));
  CHECK(refused({5, std::nan(""), 100, 1}));
}

TEST_CASE("mean distances from counts of bits are exact") {
  const std::vector<LdbCode> one = test::random_codes(600, 6);
  const std::vector<LdbCode> two = test::walk_codes(50, 7);
  const std::vector<size_t> unreadable = {7, 599};
  const std::vector<CodeSpan> spans = {{one, unreadable}, {two, {}}};
  const BitCounts all = count_bits(spans);
  CHECK(all.frames == 648);
  const LdbCode query = test::random_codes(1, 8)[0];
  const auto mean = [&](size_t from) {
    uint64_t sum = 0;
    for (size_t s = from; s < 2; ++s)
      for (size_t i = 0; i < spans[s].codes.size(); ++i)
        if (s == 1 || (i != 7 && i != 599)) sum += plain_hamming(spans[s].codes[i], query);
    return static_cast<double>(sum) / (from == 0 ? 648 : 50);
  };
  CHECK(mean_distance(all, code_words(query)) == mean(0));
  const BitCounts first = count_bits(std::span(spans).first(1));
  CHECK(mean_distance(without(all, first), code_words(query)) == mean(1));
  CHECK(mean_distance({}, code_words(query)) == 0);
}

TEST_CASE("the distance of two codes is that of the oracle") {
  const std::vector<LdbCode> codes = test::random_codes(20, 9);
  for (const LdbCode& a : codes)
    for (const LdbCode& b : codes)
      REQUIRE(code_distance(code_words(a), code_words(b)) == plain_hamming(a, b));
}
