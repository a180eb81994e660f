#include "match/distance_statistics.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "reference/reference.h"
#include "support.h"

using namespace vpr;

namespace {

// The reference implementation, in double precision.
TrainStatistics reference_statistics(std::span<const DescribedFrames> sequences, size_t reach) {
  struct Frame {
    size_t sequence;
    size_t index;
    DescriptorRow code;
    bool readable;
  };
  std::vector<Frame> frames;
  for (size_t s = 0; s < sequences.size(); ++s)
    for (size_t i = 0; i < sequences[s].rows.size(); ++i) {
      const auto& bad = sequences[s].unreadable;
      frames.push_back(
          {s, i, sequences[s].rows[i], std::find(bad.begin(), bad.end(), i) == bad.end()});
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
        distances.push_back(reference_hamming(frame.code, other.code));
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

TEST_CASE("statistics of training frames equal the reference implementation") {
  const std::vector<LdbCode> one = test::walk_codes(300, 1);
  const std::vector<LdbCode> two = test::walk_codes(90, 2);
  const std::vector<size_t> unreadable = {0, 150};
  const std::vector<DescribedFrames> spans = {{one, unreadable}, {two, {}}};
  StatisticsSettings settings;
  settings.neighbor_share = 0.02;  // 6 of 300 frames, 5 (neighbor_frames) of 90
  settings.neighbor_frames = 6;
  const TrainStatistics expected = reference_statistics(spans, 6);
  for (const std::string& target : simd_targets()) {
    const test::ChosenTarget chosen(target);
    const TrainStatistics found = compute_statistics(spans, settings, {});
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

TEST_CASE("the number of neighbors grows with the sequence") {
  const std::vector<LdbCode> codes = test::walk_codes(500, 3);
  const DescribedFrames span{codes, {}};
  const TrainStatistics expected = reference_statistics(std::span(&span, 1), 10);
  const TrainStatistics found = compute_statistics({&span, 1}, {}, {});
  for (size_t i = 0; i < 500; ++i) REQUIRE(found.bias[i] == Approx(expected.bias[i]).margin(1e-4));
}

TEST_CASE("long training data are sampled, equally for equal seeds") {
  const std::vector<LdbCode> codes = test::walk_codes(3000, 4);
  const DescribedFrames span{codes, {}};
  const std::span<const DescribedFrames> train(&span, 1);
  StatisticsSettings settings;
  settings.samples = 500;
  const std::vector<size_t> frames = sampled_frames(train, settings);
  CHECK(frames.size() == 500);
  CHECK(std::is_sorted(frames.begin(), frames.end()));
  CHECK(std::adjacent_find(frames.begin(), frames.end()) == frames.end());
  CHECK(sampled_frames(train, settings) == frames);
  const TrainStatistics all = compute_statistics(train, {}, {});
  const TrainStatistics some = compute_statistics(train, settings, {});
  CHECK(some == compute_statistics(train, settings, {}));
  for (size_t i = 0; i < 3000; ++i)
    REQUIRE(std::abs(some.bias[i] - all.bias[i]) < 5);  // a tenth of a deviation
  settings.seed = 2;
  CHECK(sampled_frames(train, settings) != frames);
}

TEST_CASE("too short training data have no bias") {
  for (const size_t count : {1, 3, 6}) {
    const std::vector<LdbCode> codes = test::walk_codes(count, 5);
    const DescribedFrames span{codes, {}};
    const TrainStatistics found = compute_statistics({&span, 1}, {}, {});
    CHECK(found.typical_distance == 400);
    for (size_t i = 0; i < count; ++i) {
      CHECK(found.bias[i] == 0);
      CHECK(found.variance[i] == 64 * 64);
    }
  }
}

TEST_CASE("statistics settings out of range are refused") {
  const auto refused = [](const StatisticsSettings& settings) {
    return test::error_kind([&] { compute_statistics({}, settings, {}); }) == ErrorKind::usage;
  };
  CHECK(refused({5, 0.02, 0, 1}));
  CHECK(refused({5, 0.02, 2'000'000, 1}));
  CHECK(refused({5, -0.1, 100, 1}));
  CHECK(refused({5, std::nan(""), 100, 1}));
}

TEST_CASE("mean distances to whole sets are exact") {
  const std::vector<LdbCode> one = test::random_codes(600, 6);
  const std::vector<LdbCode> two = test::walk_codes(50, 7);
  const std::vector<size_t> unreadable = {7, 599};
  const std::vector<DescribedFrames> spans = {{one, unreadable}, {two, {}}};
  const std::vector<LdbCode> query = test::random_codes(1, 8);
  const FrameDistances all = frame_distances(spans, {query, {}});
  CHECK(all.readable_frames == 648);
  const auto mean = [&](size_t from) {
    uint64_t sum = 0;
    for (size_t s = from; s < 2; ++s)
      for (size_t i = 0; i < spans[s].rows.size(); ++i)
        if (s == 1 || (i != 7 && i != 599)) sum += reference_hamming(spans[s].rows[i], query[0]);
    return static_cast<double>(sum) / (from == 0 ? 648 : 50);
  };
  CHECK(row_mean(all, 0) == mean(0));
  CHECK(row_mean(frame_distances(std::span(spans).subspan(1), {query, {}}), 0) == mean(1));
  CHECK(row_mean(frame_distances({}, {query, {}}), 0) == 0);
}

TEST_CASE("the distance of two codes equals the reference implementation") {
  const std::vector<LdbCode> codes = test::random_codes(20, 9);
  for (size_t a = 0; a < codes.size(); ++a)
    for (size_t b = 0; b < codes.size(); ++b)
      REQUIRE(frame_distance(codes, a, b) == reference_hamming(codes[a], codes[b]));
}

TEST_CASE("constants for LDB are scaled to other largest distances") {
  CHECK(reference_bit(largest_distance(kLdbShape)) == 1);
  CHECK(unknown_distance(1386) == 400);
  CHECK(unknown_deviation(1386) == 64);
  CHECK(unknown_distance(2 * 1386) == 800);
  const std::vector<uint8_t> bytes(3 * 8, 0);
  const DescribedFrames short_codes{{{ElementType::bits, 63}, bytes}, {}};
  const TrainStatistics found = compute_statistics({&short_codes, 1}, {}, {});
  CHECK(found.typical_distance == Approx(400.0 * 63 / 1386));
  CHECK(found.variance[2] == Approx(64.0 * 64 * 63 * 63 / 1386 / 1386));
}

TEST_CASE("statistics of distances with squares above 32 bits equal the reference implementation") {
  // 60 000 bits: all of them, or none.
  const DescriptorShape shape{ElementType::bits, 60'000};
  std::vector<uint8_t> bytes(200 * shape.row_bytes(), 0);
  for (size_t i = 0; i < 200; i += 3)
    std::fill_n(bytes.begin() + static_cast<ptrdiff_t>(i * shape.row_bytes()), 7500, uint8_t{255});
  const DescribedFrames span{{shape, bytes}, {}};
  const TrainStatistics expected = reference_statistics({&span, 1}, 5);
  const TrainStatistics found = compute_statistics({&span, 1}, {}, {});
  CHECK(found.typical_distance == Approx(expected.typical_distance).epsilon(1e-12));
  for (size_t i = 0; i < 200; ++i) {
    REQUIRE(found.bias[i] == Approx(expected.bias[i]).epsilon(1e-5).margin(1e-3));
    REQUIRE(found.variance[i] == Approx(expected.variance[i]).epsilon(1e-5));
  }
}
