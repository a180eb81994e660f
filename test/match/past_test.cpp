// A sequence against its own past: windows and scores equal reference implementations, without any
// influence of later frames.
#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/simd.h"
#include "loops/loops.h"
#include "match/checks.h"
#include "match/score_kernels.h"
#include "reference/reference_past.h"
#include "truth/times.h"

using namespace vpr;
using test::by_method;
using test::Cells;
using test::cells_of;

namespace {

struct Walk {
  std::vector<LdbCode> codes;
  std::vector<size_t> unreadable;
  std::vector<uint32_t> past;

  DescribedFrames span() const { return {codes, unreadable}; }
  std::vector<DescribedFrames> spans() const { return {span()}; }
};

// Half a sequence twice, so that there are loops.
Walk make_walk(size_t frames, const LoopGap& gap, uint64_t seed) {
  Walk walk{test::walk_codes((frames + 1) / 2, seed), {}, past_frames(gap, {}, frames)};
  for (size_t f = 0; walk.codes.size() < frames; ++f) walk.codes.push_back(walk.codes[f]);
  return walk;
}

// Frames at intervals of 10 to 60 ms.
std::vector<int64_t> uneven_times(size_t frames, uint64_t seed) {
  RandomEngine engine(seed);
  std::vector<int64_t> times;
  int64_t time = 0;
  for (size_t f = 0; f < frames; ++f) {
    time += 10'000'000 + static_cast<int64_t>(uniform_below(engine, 50'000'001));
    times.push_back(time);
  }
  return times;
}

bool is_broken(const Walk& walk, size_t first, size_t length) {
  return std::any_of(walk.unreadable.begin(), walk.unreadable.end(),
                     [&](size_t f) { return f >= first && f < first + length; });
}

// All pairs of windows in which the earlier one ends in the past of the later one.
Cells reference_past_cells(const Walk& walk, size_t length) {
  Cells cells;
  for (size_t j = 0; j + length <= walk.codes.size(); ++j)
    for (size_t i = 0; i + length <= walk.codes.size(); ++i)
      if (i + length - 1 < walk.past[j + length - 1] && !is_broken(walk, i, length) &&
          !is_broken(walk, j, length))
        cells[{j, 0, i}] = reference_window_distance(walk.codes, i, walk.codes, j, length);
  return cells;
}

FrameDistances distances_of(const Walk& walk) {
  FrameDistances distances = frame_distances(walk.spans(), walk.span());
  distances.past = walk.past;
  return distances;
}

void check_methods(const Walk& walk, size_t length) {
  const Cells expected = reference_past_cells(walk, length);
  for (const SequenceMethod& method : exact_methods()) {
    for (const size_t memory : {size_t{1} << 30, size_t{0}}) {
      INFO(method.name << ", " << walk.codes.size() << " frames, c_l " << length << ", memory "
                       << memory);
      REQUIRE(cells_of(distances_of(walk), by_method(method, length, memory)) == expected);
    }
  }
}

Cells past_scores(const Walk& walk, size_t length) {
  return cells_of(past_zscores(distances_of(walk)),
                  by_method(find_sequence_method("fastable"), length));
}

// The largest difference between fast and reference scores, in tolerances; requires all cells.
double worst_score(const Walk& walk, size_t length) {
  const Cells fast = past_scores(walk, length);
  const Cells raw = reference_past_cells(walk, length);
  REQUIRE(fast.size() == raw.size());
  const ReferencePast shared = reference_past(walk.span(), walk.past, {});
  std::vector<std::vector<double>> columns;
  for (size_t i = 0; i < walk.codes.size(); ++i)
    columns.push_back(
        reference_past_scores(walk.span(), walk.past, shared, i, walk.codes.size() - 1));
  double worst = 0;
  for (const auto& [key, sum] : fast) {
    if (!raw.contains(key)) FAIL("a cell that is none");
    const auto& [j, s, i] = key;
    double right = 0;
    for (size_t k = 0; k < length; ++k) right += columns[i + k][j + k];
    const double found = (double(sum) - double(length) * kScoreBias) / kScoreUnit;
    worst = std::max(worst, std::abs(found - right) / (double(length) / kScoreUnit));
  }
  return worst;
}

}  // namespace

TEST_CASE("a gap of frames, computed by hand") {
  CHECK(past_frames({{}, 2}, {}, 5) == std::vector<uint32_t>{0, 0, 1, 2, 3});
  CHECK(past_frames({{}, 1}, {}, 3) == std::vector<uint32_t>{0, 1, 2});
  // No frame is in its own past.
  CHECK(past_frames({{}, 0}, {}, 3) == std::vector<uint32_t>{0, 1, 2});
  CHECK(past_frames({{}, 9}, {}, 3) == std::vector<uint32_t>{0, 0, 0});
  CHECK(past_frames({{}, 9}, {}, 0).empty());
  const std::vector<int64_t> times = {0, 1 * kSecond, 5 * kSecond, 6 * kSecond, 20 * kSecond};
  CHECK(past_frames({5 * kSecond, 0}, times, 5) == std::vector<uint32_t>{0, 0, 1, 2, 4});
}

TEST_CASE("gaps are numbers of frames or seconds") {
  CHECK(parse_loop_gap("300", "--gap").frames == 300);
  CHECK(!parse_loop_gap("300", "--gap").nanoseconds);
  CHECK(parse_loop_gap("2.5s", "--gap").nanoseconds == 5 * kSecond / 2);
  for (const char* text : {"", "s", "0", "-1", "2.5", "1e10", "many", "nans"})
    CHECK_THROWS_AS(parse_loop_gap(text, "--gap"), Error);
}

TEST_CASE("windows of two frames of a sequence of five, computed by hand") {
  // Codes with 0, 1, 2, 3 and 0 bits set in the first byte.
  Walk walk{std::vector<LdbCode>(5, LdbCode{}), {}, past_frames({{}, 2}, {}, 5)};
  walk.codes[1][0] = 0b1;
  walk.codes[2][0] = 0b11;
  walk.codes[3][0] = 0b111;
  // The window that ends at frame 3 matches the one that ends at 1; the last one also matches the
  // one that ends at 2.
  const Cells expected = {{{2, 0, 0}, 2 + 2}, {{3, 0, 0}, 3 + 1}, {{3, 0, 1}, 2 + 2}};
  CHECK(reference_past_cells(walk, 2) == expected);
  check_methods(walk, 2);
}

TEST_CASE("every exact method equals the reference implementation for every gap and length") {
  for (const std::string& target : simd_targets()) {
    const test::ChosenTarget chosen(target);
    for (const size_t gap : {0, 1, 2, 7, 30, 35, 36, 37, 50}) {
      Walk walk = make_walk(37, {{}, gap}, gap + 1);
      for (const size_t length : {1, 2, 5, 18, 36, 37, 38}) check_methods(walk, length);
      walk.unreadable = {0, 11, 12, 36};
      for (const size_t length : {1, 2, 5, 18}) check_methods(walk, length);
    }
  }
}

TEST_CASE("gaps in time are measured between the last frames of windows") {
  for (const uint64_t seed : {1, 2, 3}) {
    Walk walk = make_walk(90, {{}, 1}, seed);
    const std::vector<int64_t> times = uneven_times(90, seed);
    for (const int64_t gap : {kSecond / 20, kSecond / 2, kSecond, 10 * kSecond}) {
      walk.past = past_frames({gap, 0}, times, 90);
      for (const size_t length : {1, 4, 20}) {
        check_methods(walk, length);
        CHECK(worst_score(walk, length) <= 1);
      }
    }
  }
}

TEST_CASE(
    "sequences larger than a chunk, a strip and a tile have the same cells, for any threads") {
  const Walk walk = make_walk(2300, {{}, 140}, 5);
  constexpr size_t kWindows = 2300 - 2;
  std::vector<uint32_t> expected = test::reference_fastable(walk.codes, walk.codes, 3);
  for (size_t j = 0; j < kWindows; ++j)
    for (size_t i = 0; i < kWindows; ++i)
      if (i + 2 >= walk.past[j + 2]) expected[j * kWindows + i] = kNoCell;
  const auto matrix_of = [](const FrameDistances& distances, const char* method) {
    return test::matrix_of(distances, by_method(find_sequence_method(method), 3), kWindows,
                           {kWindows});
  };
  const std::vector<uint32_t> scores = matrix_of(past_zscores(distances_of(walk)), "fastable");
  for (const size_t threads : {1, 7}) {
    const ThreadLimit limit(threads);
    for (const char* method : {"fastable", "fastable-online"}) {
      REQUIRE(matrix_of(distances_of(walk), method) == expected);
      REQUIRE(matrix_of(past_zscores(distances_of(walk)), method) == scores);
    }
  }
}

TEST_CASE("sequences with one frame, or without permitted matches, have no cell") {
  for (const auto& [frames, gap] : {std::pair<size_t, size_t>{1, 1}, {1, 0}, {5, 5}, {5, 900}}) {
    const Walk walk = make_walk(frames, {{}, gap}, 3);
    check_methods(walk, 1);
    CHECK(past_scores(walk, 1).empty());
  }
}

TEST_CASE("causal z-scores equal the reference implementation") {
  Walk walk = make_walk(150, {{}, 12}, 8);
  walk.unreadable = {0, 3, 40, 41, 99, 149};
  for (const size_t length : {1, 7}) CHECK(worst_score(walk, length) <= 1);
}

TEST_CASE("all targets yield the same causal z-scores") {
  const Walk walk = make_walk(200, {{}, 9}, 4);
  const Cells expected = past_scores(walk, 5);
  for (const std::string& target : simd_targets()) {
    const test::ChosenTarget chosen(target);
    CHECK(past_scores(walk, 5) == expected);
  }
}

TEST_CASE("a shorter sequence has the same scores up to its end") {
  const Walk walk = make_walk(160, {{}, 15}, 6);
  const Cells whole = past_scores(walk, 4);
  for (const size_t frames : {20, 81, 159}) {
    Walk part = walk;
    part.codes.resize(frames);
    part.past.resize(frames);
    Cells expected = whole;
    std::erase_if(expected, [&](const auto& cell) { return std::get<0>(cell.first) + 4 > frames; });
    CHECK(past_scores(part, 4) == expected);
  }
}

TEST_CASE("causal z-scores of three frames equal values computed by hand") {
  // Frames 0, 1 and 2 have 0, 200 and 400 bits set.
  Walk walk{std::vector<LdbCode>(3, LdbCode{}), {}, past_frames({{}, 1}, {}, 3)};
  std::fill_n(walk.codes[1].begin(), 25, uint8_t{255});
  std::fill_n(walk.codes[2].begin(), 50, uint8_t{255});
  // Frame 1 has one distance, its mean: x = 0. Frame 2 has 400 and 200, which differ by 100 from
  // their mean. Frame 0 starts with a variance of (20 * 64^2 + 0) / 21, frame 1 with (20 * 64^2 +
  // 20000) / 23, so z is 1.6011 and -1.5022.
  const Cells expected = {
      {{1, 0, 0}, kScoreBias}, {{2, 0, 0}, kScoreBias + 1640}, {{2, 0, 1}, kScoreBias - 1538}};
  CHECK(past_scores(walk, 1) == expected);
}
