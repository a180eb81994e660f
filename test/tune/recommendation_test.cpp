#include <catch2/catch.hpp>

#include "tune/sweep.h"

using namespace vpr;

namespace {

using Cells = std::vector<CellCounts>;

CellCounts cell_of(uint64_t correct, uint64_t incorrect, uint64_t window,
                   std::optional<double> threshold) {
  CellCounts cell;
  cell.window = window;
  cell.threshold = threshold;
  cell.counts.recognitions = {correct, incorrect, 0};
  return cell;
}

// Correct and incorrect recognitions at thresholds 0.1, 0.2, ...
Cells ladder(uint64_t window, const std::vector<std::pair<uint64_t, uint64_t>>& recognitions) {
  Cells cells;
  for (size_t t = 0; t < recognitions.size(); ++t)
    cells.push_back(cell_of(recognitions[t].first, recognitions[t].second, window,
                            0.1 * static_cast<double>(t + 1)));
  return cells;
}

Cells joined(Cells a, const Cells& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

Recommendation recommend(const Cells& cells) { return vpr::recommend(cells, ScoreOrder::distance); }

}  // namespace

TEST_CASE(
    "the recommended setting has no incorrect recognition, nor have any stricter ones and the next "
    "looser "
    "one") {
  // 0.2 is the last one with an error-free neighbor: the error is at 0.4.
  const Recommendation choice = ::recommend(ladder(20, {{3, 0}, {7, 0}, {9, 0}, {20, 1}, {50, 9}}));
  CHECK(choice.advice == Advice::recommended);
  CHECK(choice.cell == 1);
  CHECK(choice.first_error == 3);
  CHECK(!choice.near_miss);
  CHECK(choice.pareto == std::vector<size_t>{2, 3, 4});
}

TEST_CASE("a setting without an error above one with an error is not recommended") {
  // For clusters, an incorrect one may merge into a correct one. Recognitions of real sweeps only
  // increase.
  const Recommendation choice =
      ::recommend(ladder(10, {{5, 0}, {9, 4}, {24, 0}, {30, 0}, {40, 0}}));
  CHECK(!choice.cell);
  CHECK(choice.advice == Advice::next_errs);
  CHECK(choice.near_miss == 0);
  CHECK(choice.first_error == 1);
}

TEST_CASE(
    "the most correct recognitions win, then the shortest window, then the strictest threshold") {
  const auto scores =
      joined(joined(ladder(40, {{4, 0}, {8, 0}, {8, 0}, {9, 1}}), ladder(5, {{7, 0}, {7, 0}})),
             ladder(20, {{8, 0}, {8, 0}, {8, 0}}));
  const Recommendation choice = ::recommend(scores);
  CHECK(choice.cell == 6);  // c_l 20, 0.1: the same 8 recognitions as c_l 40 and as 0.2
  CHECK(!choice.first_error);
}

TEST_CASE(
    "windows that are incorrect without their place are errors, without the next looser setting") {
  Cells scores = ladder(10, {{3, 0}, {7, 0}, {9, 0}, {20, 0}});
  const std::vector<uint64_t> unknown_place = {0, 0, 2, 5};
  for (size_t t = 0; t < scores.size(); ++t) scores[t].unknown_place = unknown_place[t];
  Recommendation choice = ::recommend(scores);
  CHECK(choice.advice == Advice::recommended);
  CHECK(choice.cell == 1);
  CHECK(choice.first_error == 2);
  CHECK(!choice.near_miss);
  scores[1].counts.recognitions.incorrect = 1;
  CHECK(::recommend(scores).cell == 0);
  scores[0].unknown_place = 1;
  choice = ::recommend(scores);
  CHECK(!choice.cell);
  CHECK(choice.advice == Advice::always_errors);
}

TEST_CASE("a larger t_p is stricter") {
  Cells cells;
  for (const auto& [t_p, correct, incorrect] : std::vector<std::tuple<double, uint64_t, uint64_t>>{
           {0.5, 30, 8}, {0.9, 20, 0}, {0.99, 12, 0}, {0.6, 25, 3}})
    cells.push_back(cell_of(correct, incorrect, 0, t_p));
  const Recommendation choice = recommend(cells, ScoreOrder::similarity);
  CHECK(choice.cell == 2);
  CHECK(choice.first_error == 3);  // 0.6, the next looser one after 0.9
}

TEST_CASE("without a recommendation, the reason is stated") {
  const auto advice = [](const Cells& scores) {
    const Recommendation choice = ::recommend(scores);
    CHECK(!choice.cell);
    return choice.advice;
  };
  CHECK(advice({}) == Advice::no_recognitions);
  CHECK(advice(ladder(5, {{0, 0}, {0, 0}})) == Advice::no_recognitions);
  CHECK(advice(ladder(5, {{0, 0}, {0, 3}})) == Advice::no_correct_recognitions);
  CHECK(advice(ladder(5, {{0, 0}, {4, 3}})) == Advice::always_errors);
  CHECK(advice(ladder(5, {{0, 0}, {4, 0}, {9, 3}})) == Advice::next_errs);
  CHECK(advice(ladder(5, {{0, 0}, {4, 0}})) == Advice::grid_ends);
  CHECK(advice(ladder(5, {{4, 0}})) == Advice::grid_ends);
  CHECK(advice({cell_of(4, 0, 5, {})}) == Advice::only_automatic);
  // An automatic threshold is not one of the numbers.
  CHECK(advice({cell_of(4, 0, 5, {}), cell_of(4, 0, 5, 0.3)}) == Advice::grid_ends);
  CHECK(::recommend(ladder(5, {{0, 0}, {4, 0}})).near_miss == 1);
  CHECK(!::recommend(ladder(5, {{0, 0}, {4, 0}})).first_error);
}
