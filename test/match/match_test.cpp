// The contract of every sequence method: the cells of the reference implementation, each once.
#include "match/match.h"

#include <algorithm>
#include <mutex>

#include <catch2/catch.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "base/simd.h"
#include "match/checks.h"
#include "match/lsh.h"

using namespace vpr;
using test::Cells;
using test::Example;
using test::make_example;

namespace {

bool touches(const std::vector<size_t>& frames, size_t first, size_t count) {
  return std::any_of(frames.begin(), frames.end(),
                     [&](size_t f) { return f >= first && f < first + count; });
}

Cells reference_cells(const Example& example, size_t length) {
  Cells cells;
  for (size_t s = 0; s < example.train.size(); ++s)
    for (size_t j = 0; j + length <= example.query.size(); ++j)
      for (size_t i = 0; i + length <= example.train[s].size(); ++i)
        if (!touches(example.query_unreadable, j, length) &&
            !touches(example.train_unreadable[s], i, length))
          cells[{j, s, i}] =
              reference_window_distance(example.train[s], i, example.query, j, length);
  return cells;
}

// All cells by the recurrence, as test::matrix_of returns them.
std::vector<uint32_t> reference_matrix(const Example& example, size_t length) {
  std::vector<std::vector<uint32_t>> sequences;
  for (const std::vector<LdbCode>& train : example.train)
    sequences.push_back(test::reference_fastable(train, example.query, length));
  std::vector<uint32_t> matrix;
  for (size_t j = 0; j + length <= example.query.size(); ++j)
    for (size_t s = 0; s < example.train.size(); ++s)
      for (size_t i = 0, windows = example.train[s].size() + 1 - length; i < windows; ++i)
        matrix.push_back(touches(example.query_unreadable, j, length) ||
                                 touches(example.train_unreadable[s], i, length)
                             ? kNoCell
                             : sequences[s][j * windows + i]);
  return matrix;
}

Cells found_by(const Example& example, const SequenceMethod& method, size_t length, size_t memory) {
  const std::vector<DescribedFrames> spans = example.spans();
  return test::cells_of(frame_distances(spans, {example.query, example.query_unreadable}),
                        test::by_method(method, length, memory));
}

Cells by_lsh(const Example& example, const MatchSettings& settings) {
  const std::vector<DescribedFrames> spans = example.spans();
  Cells cells;
  std::mutex mutex;
  match_lsh(frame_distances(spans, {example.query, example.query_unreadable}), settings, {},
            test::collecting(cells, mutex));
  return cells;
}

void check_all_methods(const Example& example, size_t length) {
  const Cells expected = reference_cells(example, length);
  for (const SequenceMethod& method : exact_methods()) {
    for (const size_t memory : {size_t{1} << 30, size_t{0}}) {
      INFO(method.name << ", " << simd_target() << ", c_l " << length << ", memory " << memory);
      REQUIRE(found_by(example, method, length, memory) == expected);
    }
  }
}

}  // namespace

TEST_CASE("the reference implementation equals values computed by hand") {
  // Codes with 1, 3 and 7 in the first byte: their distances to zero are 1, 2 and 3.
  std::vector<LdbCode> train(3, LdbCode{});
  train[0][0] = 0b1;
  train[1][0] = 0b11;
  train[2][0] = 0b111;
  const std::vector<LdbCode> query(2, LdbCode{});
  CHECK(test::reference_openable(train, query, 1) == std::vector<uint32_t>{1, 2, 3, 1, 2, 3});
  CHECK(test::reference_openable(train, query, 2) == std::vector<uint32_t>{1 + 2, 2 + 3});
  CHECK(test::reference_openable(train, query, 3).empty());
  CHECK(test::reference_fastable(train, query, 2) == test::reference_openable(train, query, 2));
}

TEST_CASE("the recurrence equals the sums of windows, cell by cell") {
  const std::vector<LdbCode> train = test::walk_codes(40, 1);
  const std::vector<LdbCode> query = test::walk_codes(33, 2);
  for (size_t length = 1; length <= 34; ++length)
    REQUIRE(test::reference_fastable(train, query, length) ==
            test::reference_openable(train, query, length));
}

TEST_CASE("every method equals the reference implementation, for any length and SIMD target") {
  const Example example = make_example({37}, 29, 1);
  for (const std::string& target : simd_targets()) {
    const test::ChosenTarget chosen(target);
    for (size_t length = 1; length <= 38; ++length) check_all_methods(example, length);
  }
}

TEST_CASE("windows never cross the end of a sequence, nor an unreadable frame") {
  Example example = make_example({9, 1, 20, 3, 8, 16}, 23, 2);
  example.train_unreadable[2] = {0, 7, 8, 19};
  example.train_unreadable[5] = {15};
  example.query_unreadable = {4, 22};
  for (const std::string& target : simd_targets()) {
    const test::ChosenTarget chosen(target);
    for (size_t length = 1; length <= 21; ++length) check_all_methods(example, length);
  }
}

TEST_CASE("one frame against one frame") {
  const Example example = make_example({1}, 1, 3);
  for (const size_t length : {1, 2}) check_all_methods(example, length);
}

TEST_CASE("sets larger than a chunk, a strip and a tile have the same cells, for any threads") {
  Example example = make_example({5000, 700, 3001}, 150, 4);
  example.train_unreadable[0] = {2047, 2048, 4095};
  example.query_unreadable = {63};
  const std::vector<DescribedFrames> spans = example.spans();
  for (const size_t length : {1, 7, 64}) {
    const std::vector<uint32_t> expected = reference_matrix(example, length);
    const std::vector<size_t> windows = {5001 - length, 701 - length, 3002 - length};
    for (const size_t threads : {1, 2, 5}) {
      const ThreadLimit limit(threads);
      for (const SequenceMethod& method : exact_methods())
        for (const size_t memory : {size_t{1} << 30, size_t{0}})
          REQUIRE(test::matrix_of(frame_distances(spans, {example.query, example.query_unreadable}),
                                  test::by_method(method, length, memory), 151 - length,
                                  windows) == expected);
    }
  }
}

TEST_CASE("online matching with several threads equals the reference implementation") {
  // Above 65536 frames, two threads share a row.
  const std::vector<LdbCode> train = test::walk_codes(70'001, 5);
  const std::vector<LdbCode> query = test::walk_codes(40, 6);
  const DescribedFrames span{train, {}};
  const FrameDistances distances = frame_distances({&span, 1}, {query, {}});
  for (const size_t length : {1, 3, 30}) {
    for (const size_t memory : {size_t{1} << 30, size_t{0}}) {
      size_t cells = 0;
      const auto check = [&](const ScoreRow& row) {
        for (size_t x = 0; x < row.scores.size(); x += 997, ++cells)
          REQUIRE(row.scores[x] == reference_window_distance(train, row.train_window + x, query,
                                                             row.query_window, length));
        const size_t last = row.scores.size() - 1;
        REQUIRE(row.scores[last] == reference_window_distance(train, row.train_window + last, query,
                                                              row.query_window, length));
      };
      MatchSettings settings{length, memory};
      settings.method = &find_sequence_method("fastable-online");
      match(distances, settings, {{check}}, {});
      CHECK(cells > 0);
    }
  }
}

TEST_CASE("several window lengths in one pass yield the rows of each one alone") {
  Example example = make_example({300, 7, 90}, 150, 9);
  example.train_unreadable[0] = {100};
  example.query_unreadable = {70};
  const std::vector<size_t> lengths = {5, 1, 40, 12, 40, 149};
  const std::vector<DescribedFrames> spans = example.spans();
  for (const size_t memory : {size_t{1} << 30, size_t{0}}) {
    std::vector<Cells> cells(lengths.size());
    std::mutex mutex;
    std::vector<Pass> passes;
    for (size_t l = 0; l < lengths.size(); ++l)
      passes.push_back({lengths[l], {{test::collecting(cells[l], mutex)}}});
    match(frame_distances(spans, {example.query, example.query_unreadable}), {1, memory}, passes,
          {});
    for (size_t l = 0; l < lengths.size(); ++l)
      REQUIRE(cells[l] == reference_cells(example, lengths[l]));
  }
}

TEST_CASE("hashing finds exact cells, each once, the same for any threads") {
  Example example = make_example({60, 3, 200}, 40, 7);
  example.train_unreadable[2] = {90};
  example.query_unreadable = {20};
  // Identical windows share every bucket and must be found.
  std::copy_n(example.train[2].begin() + 100, 12, example.query.begin());
  for (const size_t length : {1, 4, 12}) {
    const Cells expected = reference_cells(example, length);
    MatchSettings settings{length, size_t{1} << 30};
    settings.lsh = {4, 6, 1};
    const Cells found = by_lsh(example, settings);
    CHECK(found.size() < expected.size());
    for (const auto& [cell, distance] : found) REQUIRE(expected.at(cell) == distance);
    for (size_t window = 0; window + length <= 12; ++window)
      CHECK(found.contains({window, 2, 100 + window}));
    for (const size_t threads : {1, 5}) {
      const ThreadLimit limit(threads);
      CHECK(by_lsh(example, settings) == found);
    }
    settings.seed = 2;
    if (length > 1) CHECK(by_lsh(example, settings) != found);
    // With as many probes as bits, every window is in a probed bucket.
    settings.lsh = {1, 3, 3};
    CHECK(by_lsh(example, settings) == expected);
  }
}

TEST_CASE("hashing settings out of range are refused") {
  const Example example = make_example({9}, 9, 1);
  for (const LshSettings& lsh : {LshSettings{0, 6, 1}, LshSettings{999, 6, 1},
                                 LshSettings{1, 29, 1}, LshSettings{1, 6, 5}}) {
    MatchSettings settings{2, size_t{1} << 30};
    settings.lsh = lsh;
    CHECK(test::error_kind([&] { by_lsh(example, settings); }) == ErrorKind::usage);
  }
}

TEST_CASE("an unknown method is refused with a list of the known ones") {
  const std::string text = test::error_text([] { find_sequence_method("fastabel"); });
  for (const SequenceMethod& method : sequence_methods()) CHECK(test::has(text, method.name));
}
