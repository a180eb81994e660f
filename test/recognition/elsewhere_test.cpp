// A walk compared with itself.
#include "recognition/elsewhere.h"

#include <algorithm>

#include <catch2/catch.hpp>

#include "base/parallel.h"
#include "matching/fastable_batch.h"
#include "matching/plain.h"
#include "recognition/closest_windows.h"
#include "support.h"

using namespace vpr;

namespace {

bool can_read(const DescriptorSpan& walk, size_t frame) {
  return !std::binary_search(walk.unreadable.begin(), walk.unreadable.end(), frame);
}

// Means over all pairs of readable frames, and over those k apart.
size_t slow_half_width(const DescriptorSpan& walk) {
  const size_t frames = walk.rows.size();
  const auto mean = [&](const auto& is_pair) {
    double sum = 0;
    double count = 0;
    for (size_t i = 0; i < frames; ++i)
      for (size_t j = i + 1; j < frames; ++j) {
        if (!can_read(walk, i) || !can_read(walk, j) || !is_pair(i, j)) continue;
        sum += plain_hamming(walk.rows[i], walk.rows[j]);
        ++count;
      }
    return count == 0 ? -1 : sum / count;
  };
  const double typical = mean([](size_t, size_t) { return true; });
  for (size_t k = 1; k < frames; ++k)
    if (mean([&](size_t i, size_t j) { return j == i + k; }) >= typical / 2) return k;
  return frames;
}

bool fits(const DescriptorSpan& walk, size_t window, size_t length) {
  for (size_t f = window; f < window + length; ++f)
    if (!can_read(walk, f)) return false;
  return true;
}

// Mean distance of two different frames that can be read.
double slow_mean(const DescriptorSpan& walk) {
  double sum = 0;
  double count = 0;
  for (size_t i = 0; i < walk.rows.size(); ++i)
    for (size_t j = 0; j < walk.rows.size(); ++j) {
      if (i == j || !can_read(walk, i) || !can_read(walk, j)) continue;
      sum += plain_hamming(walk.rows[i], walk.rows[j]);
      ++count;
    }
  return sum / count;
}

// In steps of -1 or 1 from a window.
size_t slow_reach(const DescriptorSpan& walk, size_t length, size_t window, int step) {
  const size_t frames = walk.rows.size();
  const double half = slow_mean(walk) / 2 * static_cast<double>(length);
  for (size_t apart = 1;; ++apart) {
    if (step < 0 ? apart > window : window + apart + length > frames) return frames;
    const size_t other = step < 0 ? window - apart : window + apart;
    if (!fits(walk, window, length) || !fits(walk, other, length)) continue;
    if (plain_window_distance(walk.rows, window, walk.rows, other, length) >= half)
      return std::max(apart, slow_half_width(walk));
  }
}

std::optional<ClosestWindows> slow_elsewhere(const DescriptorSpan& walk, size_t length) {
  const size_t windows = walk.rows.size() < length ? 0 : walk.rows.size() - length + 1;
  std::optional<ClosestWindows> closest;
  for (size_t j = 0; j < windows; ++j) {
    const size_t before = slow_reach(walk, length, j, -1);
    const size_t behind = slow_reach(walk, length, j, 1);
    for (size_t i = 0; i < windows; ++i) {
      if (!fits(walk, j, length) || !fits(walk, i, length)) continue;
      if (i <= j ? j - i <= 2 * before : i - j <= 2 * behind) continue;
      const uint32_t d = plain_window_distance(walk.rows, i, walk.rows, j, length);
      if (!closest || d < closest->score) closest = ClosestWindows{d, j, 0, i};
    }
  }
  return closest;
}

std::optional<ClosestWindows> find_elsewhere(const DescriptorSpan& walk, size_t length,
                                             size_t most_pairs = kMostOwnPairs) {
  const MatchSettings settings{length, size_t{1} << 30, select_kernels()};
  return closest_elsewhere(
      walk, length, settings.kernels,
      [&](const FrameDistances& distances, const RowConsumer& consume) {
        match_fastable(distances, settings, {}, consume);
      },
      {}, most_pairs);
}

bool same(const std::optional<ClosestWindows>& a, const std::optional<ClosestWindows>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return a->score == b->score && a->window == b->window && a->other_sequence == b->other_sequence &&
         a->other_window == b->other_window;
}

}  // namespace

TEST_CASE("places change after as many frames as half the average difference takes") {
  // Four frames of one place, then four of another that differs in every bit of a byte or two.
  std::vector<LdbCode> codes(8, LdbCode{});
  for (size_t i = 4; i < 8; ++i) codes[i][0] = 0xff;
  // 16 of 28 pairs differ by 8 bits: 32/7 on average. 1, 2, 3 apart: 8/7, 16/6, 24/5 bits.
  CHECK(half_width({codes, {}}) == 2);
  CHECK(half_width({std::vector<LdbCode>(5, LdbCode{}), {}}) == 1);  // no difference at all
  for (const int bits : {10, 60, 300}) {
    const auto walk = test::walk_codes(90, 4, bits);
    CHECK(half_width({walk, {}}) == slow_half_width({walk, {}}));
  }
}

TEST_CASE("the closest windows elsewhere are those of the definition") {
  std::vector<LdbCode> walk = test::walk_codes(70, 5, 90);
  std::copy_n(walk.begin() + 5, 9, walk.begin() + 45);  // ties at distance 0
  const std::vector<size_t> unreadable = {20, 21, 60};
  for (const size_t threads : {1, 3}) {
    const ThreadLimit limit(threads);
    for (const size_t length : {1, 2, 5, 9, 20, 33, 71}) {
      INFO("c_l " << length);
      CHECK(same(find_elsewhere({walk, {}}, length), slow_elsewhere({walk, {}}, length)));
      CHECK(same(find_elsewhere({walk, unreadable}, length),
                 slow_elsewhere({walk, unreadable}, length)));
    }
  }
  CHECK_FALSE(find_elsewhere({walk, {}}, 68));  // no two windows are far enough apart
}

TEST_CASE("a place reaches as far as its windows look alike") {
  const std::vector<LdbCode> walk = test::walk_codes(60, 5, 90);
  const std::vector<size_t> unreadable = {20, 21, 50};
  for (const auto& span : {DescriptorSpan{walk, {}}, DescriptorSpan{walk, unreadable}})
    for (const size_t length : {1, 4, 11, 60}) {
      const auto found = place_reaches(span, length);
      REQUIRE(found.size() == walk.size() - length + 1);
      for (size_t window = 0; window < found.size(); ++window)
        CHECK(found[window] == PlaceReach{slow_reach(span, length, window, -1),
                                          slow_reach(span, length, window, 1)});
    }
  CHECK(place_reaches({walk, {}}, 61).empty());
  CHECK(place_reaches({walk, {}}, 4, {}, 0).front() == PlaceReach{60, 60});
}

TEST_CASE("a stop is one place, whose windows are not elsewhere for each other") {
  std::vector<LdbCode> walk = test::walk_codes(80, 5, 90);
  const auto moving = find_elsewhere({walk, {}}, 5);
  walk.insert(walk.begin() + 40, 30, walk[40]);
  const auto stopping = find_elsewhere({walk, {}}, 5);
  REQUIRE(moving);
  REQUIRE(stopping);
  CHECK(stopping->score > 0);
  CHECK(stopping->score >= moving->score / 2);
  const auto reaches = place_reaches({walk, {}}, 5);
  CHECK(reaches[45].behind > 20);
  CHECK(reaches[45].behind > 2 * reaches[5].behind);
}

TEST_CASE("stretches that cover a walk give what the whole walk gives") {
  const auto walk = test::walk_codes(1200, 6, 90);
  CHECK(same(find_elsewhere({walk, {}}, 7, 1), find_elsewhere({walk, {}}, 7)));
  const auto long_walk = test::walk_codes(2600, 7, 90);  // a part of it: no smaller a distance
  const auto part = find_elsewhere({long_walk, {}}, 7, 1);
  REQUIRE(part);
  CHECK((part->window < 994 || part->window >= 1600));
}

TEST_CASE("a single sequence has the automatic threshold of its own windows") {
  const std::vector<LdbCode> walk = test::walk_codes(60, 1, 120);
  const DescriptorSpan span{walk, {}};
  const auto found =
      find_closest_windows({&span, 1}, nullptr, {6, size_t{1} << 30, select_kernels()}, {});
  REQUIRE(found.size() == 1);
  CHECK(same(found[0], slow_elsewhere(span, 6)));
}
