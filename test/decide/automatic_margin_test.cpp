// Margins of incorrect best matches, the automatic margin, and overlapping sequences.
#include "decide/automatic_margin.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <catch2/catch.hpp>

#include "base/parallel.h"
#include "base/random.h"
#include "decide/exclusion_zones.h"
#include "examples.h"
#include "match/reference.h"
#include "match/row_kernels.h"
#include "support.h"

using namespace vpr;

namespace {

MatchSettings match(size_t length) { return {length, kDefaultMemoryLimit, select_kernels()}; }

size_t apart(size_t a, size_t b) { return std::max(a, b) - std::min(a, b); }

/// A cell of one row: sequence, window and score.
struct Value {
  size_t sequence = 0;
  size_t window = 0;
  uint32_t score = 0;
};

// The reference implementation; returns the margin of the best one.
std::optional<uint32_t> slow_margin(const std::vector<Value>& row, const ExclusionZones& zones,
                                    const Value*& best) {
  best = nullptr;
  for (const Value& value : row)
    if (best == nullptr || value.score < best->score) best = &value;
  std::optional<uint32_t> smallest;
  for (const Value& value : row) {
    const bool is_outside = value.sequence == best->sequence
                                ? apart(value.window, best->window) > zones.widths[value.sequence]
                                : zones.shared[value.sequence][best->sequence] == 0;
    if (is_outside && (!smallest || value.score < *smallest)) smallest = value.score;
  }
  return smallest ? std::optional(*smallest - best->score) : std::nullopt;
}

std::vector<uint32_t> slow_margins(const std::vector<DescribedFrames>& walks,
                                   const ExclusionZones& zones, size_t length) {
  std::vector<uint32_t> margins;
  for (size_t own = 0; own < walks.size(); ++own) {
    const size_t gap = exclusion_radius(walks[own]) + length;
    const double mean = mean_distance_within(frame_distances({&walks[own], 1}, walks[own]));
    for (size_t j = 0; j + length <= walks[own].rows.size(); ++j) {
      std::vector<Value> far;
      std::vector<Value> others;
      for (size_t s = 0; s < walks.size(); ++s)
        for (size_t i = 0; i + length <= walks[s].rows.size(); ++i) {
          const uint32_t distance =
              reference_window_distance(walks[s].rows, i, walks[own].rows, j, length);
          if (s == own && apart(i, j) >= gap) far.push_back({s, i, distance});
          if (s != own && zones.shared[s][own] == 0) others.push_back({s, i, distance});
        }
      const Value* best = nullptr;
      const auto margin = slow_margin(far, zones, best);
      if (margin && !is_same_place(best->score / double(length), mean, length, kOwnDepth))
        margins.push_back(*margin);
      if (const auto other = slow_margin(others, zones, best)) margins.push_back(*other);
    }
  }
  std::sort(margins.begin(), margins.end(), std::greater<>());
  return margins;
}

}  // namespace

TEST_CASE("false margins equal the reference implementation, for any number of threads") {
  const test::Example example = test::make_example({70, 45, 60, 4}, 1, 5);
  const std::vector<DescribedFrames> walks = example.spans();
  for (const auto& shared : std::vector<std::vector<std::pair<size_t, size_t>>>{{}, {{0, 2}}}) {
    const ExclusionZones zones = make_exclusion_zones({2, 0, 5, 1}, shared);
    for (const size_t length : {1, 6}) {
      const std::vector<uint32_t> slow = slow_margins(walks, zones, length);
      REQUIRE(slow.size() > 100);
      for (const size_t threads : {1, 3}) {
        const ThreadLimit limit(threads);
        CHECK(false_margins(walks, zones, nullptr, match(length), {}) == slow);
      }
    }
  }
}

TEST_CASE("a sequence that shows a place twice has no false margins there") {
  std::vector<LdbCode> walk = test::walk_codes(90, 1, 200);
  std::copy_n(walk.begin() + 5, 20, walk.begin() + 60);
  const DescribedFrames span{walk, {}};
  const ExclusionZones zones = make_exclusion_zones({2}, {});
  const std::vector<uint32_t> margins = false_margins({&span, 1}, zones, nullptr, match(5), {});
  CHECK(margins == slow_margins({span}, zones, 5));
  CHECK(margins.front() < 5 * 150);  // a correct one has half of 1386 bits per frame
}

TEST_CASE("a single short sequence has no false margins, and therefore the minimum margin") {
  const std::vector<LdbCode> walk = test::walk_codes(10, 1);
  const DescribedFrames span{walk, {}};
  const auto none = false_margins({&span, 1}, make_exclusion_zones({1}, {}), nullptr, match(9), {});
  CHECK(none.empty());
  CHECK(automatic_margin(none, score_kind(Score::raw), 600, 9) == Approx(0.45 * 600 / 3));
  CHECK(automatic_margin(none, score_kind(Score::zscore), 600, 9) == 1);
}

TEST_CASE("the automatic margin is a mean above the largest false one, and at least the minimum") {
  std::vector<uint32_t> margins(101, 1000);
  margins[0] = 5000;  // the mean is 1039.6
  const auto automatic = [&](Score score, size_t length) {
    return automatic_margin(margins, score_kind(score), 600, length);
  };
  CHECK(automatic(Score::raw, 100) == 60.4);
  CHECK(automatic(Score::raw, 10'000) == Approx(2.7));  // the minimum
  CHECK(automatic(Score::zscore, 1) == 6040.0 / 1024);
  margins.assign(101, 0);
  CHECK(automatic(Score::raw, 100) == Approx(27));
}

TEST_CASE("an outlier among the false margins has no effect") {
  std::vector<uint32_t> margins(102, 1000);
  margins[0] = 90'000;  // the mean is 1911.8, and at most 8.6 times that is likely
  margins[1] = 5000;
  CHECK(automatic_margin(margins, score_kind(Score::raw), 600, 100) == 69.12);
  margins[0] = 9000;  // 8.1 times the mean, 1117.6
  CHECK(automatic_margin(margins, score_kind(Score::raw), 600, 100) == 101.18);
}

namespace {

using Walk = std::vector<LdbCode>;
using Pairs = std::vector<std::pair<size_t, size_t>>;

// The same frames in another light: one bit in eight differs.
Walk seen_again(Walk walk, uint64_t seed) {
  RandomEngine engine(seed);
  for (LdbCode& code : walk)
    for (size_t bit = 0; bit < kLdbBits; ++bit)
      if (uniform_below(engine, 8) == 0) code[bit / 8] ^= static_cast<uint8_t>(1U << (bit % 8));
  return walk;
}

Pairs find(const std::vector<Walk>& walks, size_t most_pairs = size_t{1} << 32) {
  std::vector<DescribedFrames> spans;
  std::vector<uint32_t> widths;
  for (const Walk& walk : walks) {
    spans.push_back({walk, {}});
    widths.push_back(static_cast<uint32_t>(exclusion_radius(spans.back())));
  }
  return find_overlapping_sequences(spans, widths, select_kernels(), {}, most_pairs);
}

}  // namespace

TEST_CASE("sequences of different places do not overlap, two sequences of one place do") {
  const Walk first = test::walk_codes(120, 1);
  const Walk other = test::walk_codes(110, 2);
  CHECK(find({first}).empty());
  CHECK(find({first, other}).empty());
  CHECK(find({first, other, seen_again(first, 3)}) == Pairs{{0, 2}});
}

TEST_CASE("a sequence through two places overlaps with a sequence of each, which do not overlap") {
  const Walk hall = test::walk_codes(80, 1);
  const Walk stairs = test::walk_codes(90, 2);
  Walk through = seen_again(hall, 3);
  const Walk second = seen_again(stairs, 4);
  through.insert(through.end(), second.begin(), second.end());
  CHECK(find({hall, through, stairs}) == Pairs{{0, 1}, {1, 2}});
}

TEST_CASE("too short sequences do not overlap") {
  const Walk walk = test::walk_codes(60, 1);
  CHECK(find({walk, Walk(walk.begin(), walk.begin() + 1)}).empty());
  CHECK(find({Walk(walk.begin(), walk.begin() + 7), walk}).empty());
}

TEST_CASE("long sequences are compared in parts") {
  const Walk walk = test::walk_codes(2500, 1);
  const Walk other = test::walk_codes(2200, 2);
  CHECK(find({walk, seen_again(walk, 3), other}, 1) == Pairs{{0, 1}});
}
