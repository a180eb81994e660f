// What is kept of a row's cells: no more than it can depend on.
#include <algorithm>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "decide/margin_scan.h"

using namespace vpr;

namespace {

ScoreRow piece_of(const std::vector<uint32_t>& row, size_t begin, size_t end) {
  return {0, 0, begin, std::span(row).subspan(begin, end - begin)};
}

void take(RowOutline& outline, const ScoreRow& piece) {
  const auto least = std::min_element(piece.scores.begin(), piece.scores.end());
  add_piece(outline, piece, *least, static_cast<size_t>(least - piece.scores.begin()),
            select_kernels());
}

}  // namespace

TEST_CASE("of a row that has come as a whole, the best and the best elsewhere are kept") {
  RandomEngine engine(1);
  std::vector<uint32_t> row(500);
  for (uint32_t& value : row) value = static_cast<uint32_t>(1000 + uniform_below(engine, 1000));
  for (size_t i = 0; i < 41; ++i)  // a valley, whose bottom is at 250
    row[230 + i] = static_cast<uint32_t>(20 * (std::max<size_t>(i, 20) - std::min<size_t>(i, 20)));
  RowOutline outline;
  outline.width = 15;
  take(outline, piece_of(row, 0, 500));
  CHECK(outline.points.size() == 2);
  CHECK(outline.best.window == 250);
  CHECK(smallest_outside(outline, 250) == 320);
  CHECK(outline.bound == 320);
  // Cut within the valley, the slopes are kept until the other half has come.
  RowOutline half;
  half.width = 15;
  take(half, piece_of(row, 0, 255));
  CHECK(half.points.size() > 2);
  CHECK(half.points.size() <= 4 * 15 + 4);
  take(half, piece_of(row, 255, 500));
  CHECK(half.points.size() == 2);
  CHECK(smallest_outside(half, 250) == 320);
}

TEST_CASE("a piece that can't matter is told by the bound") {
  RowOutline outline;
  outline.width = 1;
  const std::vector<uint32_t> row = {5, 6, 7, 9, 8, 9, 9, 9};
  take(outline, piece_of(row, 0, 4));
  CHECK(outline.best.window == 0);
  CHECK(smallest_outside(outline, 0) == 7);
  CHECK(outline.bound == 7);
  note_seen(outline, 4, 8);
  CHECK(outline.last == 8);
  CHECK(smallest_outside(outline, 0) == 7);
}
