// Z-scores: fast against reference implementation, and properties of the method.
#include "match/zscores.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/simd.h"
#include "match/checks.h"

using namespace vpr;
using test::Cells;
using test::Example;
using test::make_example;

namespace {

ScoreBasis make_basis(const Example& example) {
  const std::vector<DescribedFrames> spans = example.spans();
  TrainStatistics statistics = compute_statistics(spans, {}, {});
  statistics.components = compute_components(spans, statistics.typical_distance, {});
  return make_score_basis(statistics);
}

FrameDistances scores_of(const Example& example, const ScoreBasis& basis) {
  return zscores(frame_distances(example.spans(), {example.query, example.query_unreadable}),
                 basis);
}

Cells fast_cells(const Example& example, const ScoreBasis& basis, size_t length) {
  return test::cells_of(scores_of(example, basis), {length, size_t{1} << 30});
}

double score(uint32_t biased, size_t length) {
  return (static_cast<double>(biased) - static_cast<double>(length) * kScoreBias) / kScoreUnit;
}

// Compares every fast cell with the reference implementation. Returns the largest error, in units
// per frame.
double check_against_reference(const Example& example, const ScoreBasis& basis, size_t length) {
  const std::vector<DescribedFrames> spans = example.spans();
  const ReferenceUpdates updates =
      reference_updates(spans, {example.query, example.query_unreadable}, basis, {});
  std::vector<std::vector<std::vector<double>>> plain(example.train.size());
  size_t frame = 0;
  for (size_t s = 0; s < example.train.size(); ++s)
    for (const LdbCode& code : example.train[s]) {
      plain[s].push_back(reference_frame_scores(code, frame, example.query, updates, basis));
      ++frame;
    }
  double worst = 0;
  for (const auto& [cell, biased] : fast_cells(example, basis, length)) {
    const auto& [window, sequence, train_window] = cell;
    double sum = 0;
    for (size_t k = 0; k < length; ++k) sum += plain[sequence][train_window + k][window + k];
    const double difference = std::abs(sum - score(biased, length));
    REQUIRE(difference <= score_tolerance(length));
    worst = std::max(worst, difference * kScoreUnit / static_cast<double>(length));
  }
  return worst;
}

size_t window_pairs(const Example& example, size_t length) {
  return count_windows(readable_runs(example.spans()), length) *
         count_windows(readable_runs({example.query, example.query_unreadable}), length);
}

}  // namespace

TEST_CASE("a score equals the value computed by hand") {
  // Two distant frames with a query between them; without learning.
  Example example;
  example.train = {std::vector<LdbCode>(2, LdbCode{})};
  example.train_unreadable = {{}};
  for (size_t byte = 0; byte < 10; ++byte) example.train[0][1][byte] = 0xff;
  example.query = {LdbCode{}};
  for (size_t byte = 0; byte < 2; ++byte) example.query[0][byte] = 0xff;
  // Distances 16 and 64, mean 40: x = -24 and 24. No component is subtracted.
  ScoreBasis basis = make_basis(example);
  basis.components = {};
  basis.mean = {-4, 8};
  basis.variance = 256;
  const Cells cells = fast_cells(example, basis, 1);
  REQUIRE(cells.size() == 2);
  CHECK(score(cells.at({0, 0, 0}), 1) == -1.25);  // (-24 + 4) / 16
  CHECK(score(cells.at({0, 0, 1}), 1) == 1.0);    // (24 - 8) / 16
  basis.variance = 25;                            // below the floor of 10 bits
  CHECK(score(fast_cells(example, basis, 1).at({0, 0, 1}), 1) ==
        Approx(1.6).margin(0.5 / kScoreUnit));
}

TEST_CASE("the initial state is a share of each frame's bias, and the mean variance") {
  TrainStatistics statistics;
  statistics.typical_distance = 300;
  statistics.bias = {-40, 12, 28};
  statistics.variance = {100, 400, 250};
  const ScoreBasis basis = make_score_basis(statistics);
  CHECK(basis.mean == std::vector<float>{-20, 6, 14});
  CHECK(basis.variance == 250);
  CHECK(basis.typical_distance == 300);
  CHECK(basis.start_weight == 20);
  CHECK(make_score_basis(statistics, 2).start_weight == 2);
  CHECK(make_score_basis({}).variance == 0);
}

TEST_CASE("learned statistics equal values computed by hand") {
  // Every frame is a keyframe, because the typical distance is 0. The first one is learned when the
  // sixth arrives, with weight 1 against an initial weight of 1 that is forgotten to 0.98.
  Example example;
  example.train = {std::vector<LdbCode>(2, LdbCode{})};
  example.train_unreadable = {{}};
  for (size_t byte = 0; byte < 8; ++byte) example.train[0][1][byte] = 0xff;
  example.query.assign(6, LdbCode{});
  ScoreBasis basis;
  basis.start_weight = 1;
  basis.mean = {0, 0};
  basis.variance = 400;
  // Distances 0 and 64, mean 32: x = -32 and 32 in every frame.
  const Cells cells = fast_cells(example, basis, 1);
  for (size_t frame = 0; frame < 5; ++frame) {
    CHECK(score(cells.at({frame, 0, 0}), 1) == Approx(-1.6).margin(0.5 / kScoreUnit));
    CHECK(score(cells.at({frame, 0, 1}), 1) == Approx(1.6).margin(0.5 / kScoreUnit));
  }
  // After the first: mean 32 / 1.98, variance (0.98 * 400 + 32^2) / 1.98 - mean^2 = 453.96.
  const double mean = 32 / 1.98;
  const double deviation = std::sqrt(1416 / 1.98 - mean * mean);
  CHECK(deviation == Approx(21.306).margin(0.001));
  CHECK(score(cells.at({5, 0, 0}), 1) == Approx((mean - 32) / deviation).margin(0.5 / kScoreUnit));
  CHECK(score(cells.at({5, 0, 1}), 1) == Approx((32 - mean) / deviation).margin(0.5 / kScoreUnit));
}

TEST_CASE(
    "scores equal the reference implementation within one unit per frame, on every SIMD target") {
  Example example = make_example({70, 9, 40}, 60, 1);
  example.train_unreadable[0] = {3, 4};
  example.query_unreadable = {20, 59};
  const ScoreBasis basis = make_basis(example);
  for (const size_t length : {1, 2, 7, 20}) {
    const Cells expected = fast_cells(example, basis, length);
    CHECK(expected.size() == window_pairs(example, length));
    CHECK(check_against_reference(example, basis, length) < 1);
    for (const std::string& target : simd_targets()) {
      const test::ChosenTarget chosen(target);
      INFO(target);
      CHECK(fast_cells(example, basis, length) == expected);
    }
  }
}

TEST_CASE("scores equal the reference implementation for any basis") {
  const Example example = make_example({50, 30}, 70, 3);
  const ScoreBasis basis = make_basis(example);
  ScoreBasis unweighted = basis;
  unweighted.start_weight = 0;
  check_against_reference(example, unweighted, 5);
  ScoreBasis keyframes = basis;
  keyframes.typical_distance = 0;  // every frame is a keyframe
  check_against_reference(example, keyframes, 5);
  ScoreBasis without = basis;
  without.components = no_components(80);
  check_against_reference(example, without, 5);
}

TEST_CASE("sets larger than a chunk yield the same scores for any threads") {
  Example example = make_example({5000, 700, 3001}, 60, 4);
  example.train_unreadable[0] = {2047, 2048, 4095};
  const ScoreBasis basis = make_basis(example);
  check_against_reference(example, basis, 7);
  const Cells expected = fast_cells(example, basis, 7);
  for (const size_t threads : {1, 5}) {
    const ThreadLimit limit(threads);
    CHECK(fast_cells(example, basis, 7) == expected);
    CHECK(make_basis(example).mean == basis.mean);
    CHECK(make_basis(example).variance == basis.variance);
  }
}

TEST_CASE("a database that is shared between threads yields the same scores") {
  // above 65536 frames, two threads share a row
  const Example example = make_example({70'001}, 14, 5);
  const ScoreBasis basis = make_basis(example);
  Cells expected;
  for (const size_t threads : {1, 2, 3}) {
    const ThreadLimit limit(threads);
    Cells sampled;
    const auto sample = [&](const ScoreRow& row) {
      for (size_t x = 0; x < row.scores.size(); x += 97)
        sampled[{row.query_window, row.sequence, row.train_window + x}] = row.scores[x];
    };
    match(scores_of(example, basis), {6, size_t{1} << 30}, {{sample}}, {});
    if (threads == 1)
      expected = sampled;
    else
      CHECK(sampled == expected);
  }
}

TEST_CASE("scores do not change when later frames arrive") {
  const Example whole = make_example({60}, 80, 6);
  const ScoreBasis basis = make_basis(whole);
  const Cells all = fast_cells(whole, basis, 5);
  for (const size_t frames : {5, 6, 20, 41, 79}) {
    Example part = whole;
    part.query.resize(frames);
    for (const auto& [cell, value] : fast_cells(part, basis, 5)) REQUIRE(all.at(cell) == value);
  }
}

TEST_CASE("several window lengths in one pass yield the scores of each one alone") {
  Example example = make_example({300, 7, 90}, 150, 9);
  example.query_unreadable = {70};
  const std::vector<size_t> lengths = {5, 1, 40, 5, 149};
  const ScoreBasis basis = make_basis(example);
  std::vector<Cells> cells(lengths.size());
  std::vector<Pass> passes;
  for (size_t l = 0; l < lengths.size(); ++l) {
    const auto collect = [&, l](const ScoreRow& row) {
      for (size_t x = 0; x < row.scores.size(); ++x)
        cells[l][{row.query_window, row.sequence, row.train_window + x}] = row.scores[x];
    };
    passes.push_back({lengths[l], {{collect}}});
  }
  match(scores_of(example, basis), {1, size_t{1} << 30}, passes, {});
  for (size_t l = 0; l < lengths.size(); ++l)
    CHECK(cells[l] == fast_cells(example, basis, lengths[l]));
}

TEST_CASE("one training sequence of three frames, and a query of one frame") {
  for (const size_t query_frames : {1, 2, 30}) {
    const Example example = make_example({3}, query_frames, 7);
    const ScoreBasis basis = make_basis(example);
    CHECK(basis.typical_distance == 400);
    for (const size_t length : {1, 3}) {
      check_against_reference(example, basis, length);
      CHECK(fast_cells(example, basis, length).size() == window_pairs(example, length));
    }
  }
}

TEST_CASE("constant images all have the score 0") {
  Example example;
  example.train = {std::vector<LdbCode>(40, LdbCode{})};
  example.train_unreadable = {{}};
  example.query.assign(30, LdbCode{});
  for (const auto& [cell, value] : fast_cells(example, make_basis(example), 4))
    REQUIRE(value == 4 * kScoreBias);
}

TEST_CASE("scores beyond 32 deviations are clamped, without overflow") {
  Example example = make_example({40}, 1, 8);
  ScoreBasis basis = make_basis(example);
  for (size_t i = 0; i < 40; ++i) basis.mean[i] = i % 2 == 0 ? 1386 : -1386;
  basis.variance = 0;
  const Cells cells = fast_cells(example, basis, 1);
  CHECK(score(cells.at({0, 0, 0}), 1) == -32);
  CHECK(cells.at({0, 0, 1}) == 65535);
  check_against_reference(example, basis, 1);
}

TEST_CASE("a stationary query keeps the current place for any time") {
  // A walk again, with some bits changed, that stops at frame 60 for 600 frames.
  Example example;
  example.train = {test::walk_codes(200, 11, 25)};
  example.train_unreadable = {{}};
  RandomEngine engine(1);
  const auto seen_again = [&](size_t frame) {
    LdbCode code = example.train[0][frame];
    for (int i = 0; i < 200; ++i) {
      const uint64_t bit = uniform_below(engine, kLdbBits);
      code[bit / 8] = static_cast<uint8_t>(code[bit / 8] ^ 1 << bit % 8);
    }
    return code;
  };
  std::vector<LdbCode> moving;
  for (size_t i = 0; i < 120; ++i) moving.push_back(seen_again(i));
  const LdbCode stop = moving[60];
  const auto best_while_standing = [&](size_t standing, bool is_every_frame_learned) {
    example.query.assign(moving.begin(), moving.begin() + 61);
    example.query.insert(example.query.end(), standing, stop);
    example.query.insert(example.query.end(), moving.begin() + 61, moving.end());
    std::pair<uint32_t, size_t> best = {~0U, 0};
    ScoreBasis basis = make_basis(example);
    if (is_every_frame_learned) basis.typical_distance = 0;
    for (const auto& [cell, value] : fast_cells(example, basis, 1))
      if (std::get<0>(cell) == 60 + standing) best = std::min(best, {value, std::get<2>(cell)});
    return std::pair(score(best.first, 1), best.second);
  };
  const auto [score_at_once, place_at_once] = best_while_standing(0, false);
  const auto [score_later, place_later] = best_while_standing(600, false);
  CHECK(place_at_once == 60);
  CHECK(place_later == 60);
  CHECK(score_later == score_at_once);  // nothing is learned while nothing new is seen
  // If every frame is a keyframe, as much as 600 frames of the present place are learned, and it is
  // lost.
  const auto [score_lost, place_lost] = best_while_standing(600, true);
  CHECK(score_lost > score_at_once / 2);
}

TEST_CASE("a memory limit without room for the ring is an error") {
  const Example example = make_example({100}, 20, 1);
  const size_t length = 5;
  const auto try_memory = [&](size_t memory, size_t c_l) {
    match(scores_of(example, make_basis(example)), {c_l, memory}, Sinks{}, {});
  };
  const size_t needed = 2 * (32 + 128) * (length + 1);  // rows have whole cache lines
  CHECK_FALSE(test::error_kind([&] { try_memory(needed, length); }));
  CHECK(test::error_kind([&] { try_memory(needed - 1, length); }) == ErrorKind::usage);
  CHECK(test::has(test::error_text([&] { try_memory(0, length); }), "--max-memory"));
}

TEST_CASE("a stop is one keyframe, and so is a frame similar to one of the last five") {
  // Random codes differ in about 693 of 1386 bits; a few changed bits are the same keyframe.
  const std::vector<LdbCode> places = test::random_codes(9, 1);
  std::vector<LdbCode> walk = {places[0], places[0], places[1], places[1], places[1], places[2],
                               places[0], places[3], places[4], places[5], places[6], places[0]};
  walk[3][0] ^= 7;
  const double typical = 400;
  CHECK(keyframe_starts({walk, {}}, typical) == std::vector<uint32_t>{0, 2, 5, 7, 8, 9, 10, 11});
  const std::vector<size_t> unreadable = {0, 5, 10};
  CHECK(keyframe_starts({walk, unreadable}, typical) == std::vector<uint32_t>{0, 1, 2, 7, 8, 9});
  CHECK(keyframe_starts({}, typical).empty());
  CHECK(keyframe_starts({std::span<const LdbCode>(walk).first(1), {}}, typical) ==
        std::vector<uint32_t>{0});
}

TEST_CASE("a frame is a new keyframe from a quarter of the typical distance on, inclusive") {
  std::vector<LdbCode> walk = {LdbCode{}, LdbCode{}};
  for (size_t b = 0; b < 12; ++b) walk[1][b] = 0xff;  // 96 bits
  CHECK(keyframe_starts({walk, {}}, 384).size() == 2);
  CHECK(keyframe_starts({walk, {}}, 384.1).size() == 1);
}
