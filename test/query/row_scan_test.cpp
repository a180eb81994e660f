#include "query/row_scan.h"

#include <algorithm>

#include <catch2/catch.hpp>

#include "base/parallel.h"
#include "base/random.h"
#include "reference/sampled_cells.h"
#include "support.h"

using namespace vpr;

namespace {

struct ScanPiece {
  size_t query = 0;
  size_t sequence = 0;
  size_t first = 0;
  std::vector<uint32_t> scores;
};

// Two sequences of 50 and 9 windows, 20 query windows, cut into pieces.
std::vector<ScanPiece> random_pieces(uint64_t seed) {
  RandomEngine engine(seed);
  std::vector<ScanPiece> pieces;
  for (size_t query = 0; query < 20; ++query) {
    if (query == 5) continue;  // no cells
    for (size_t sequence = 0; sequence < 2; ++sequence) {
      const size_t windows = sequence == 0 ? 50 : 9;
      for (size_t first = 0; first < windows;) {
        ScanPiece piece{query, sequence, first, {}};
        const size_t count = std::min(windows - first, size_t(1 + uniform_below(engine, 20)));
        for (size_t i = 0; i < count; ++i)
          piece.scores.push_back(static_cast<uint32_t>(uniform_below(engine, 40)));
        first += count;
        pieces.push_back(piece);
      }
    }
  }
  return pieces;
}

ScoreRow as_row(const ScanPiece& piece) {
  return {piece.query, piece.sequence, piece.first, piece.scores};
}

RecognitionScanSettings scan_settings(size_t max_recognitions = 100000) {
  return {{3, 6}, 20, max_recognitions};
}

}  // namespace

TEST_CASE(
    "recognitions are strictly below their sequence's limit, and the first best match wins a tie") {
  RecognitionScan scan(scan_settings());
  scan({0, 0, 10, std::vector<uint32_t>{5, 2, 3}});
  scan({0, 1, 0, std::vector<uint32_t>{2, 5, 6}});
  scan({0, 0, 4, std::vector<uint32_t>{2}});
  const RecognitionScanResult result = scan.result();
  CHECK(result.recognitions ==
        std::vector<Cell>{{0, 0, 4, 2}, {0, 0, 11, 2}, {0, 1, 0, 2}, {0, 1, 1, 5}});
  CHECK(result.best.at(0) == Cell{0, 0, 4, 2});
  CHECK_FALSE(result.best.at(1).has_value());
}

TEST_CASE("the result does not depend on the order of rows or the number of threads") {
  const std::vector<ScanPiece> pieces = random_pieces(1);
  std::vector<Cell> recognitions;
  std::vector<std::optional<Cell>> best(20);
  std::vector<uint32_t> maxima(2, 0);
  for (const ScanPiece& piece : pieces) {
    for (size_t x = 0; x < piece.scores.size(); ++x) {
      const Cell cell{uint32_t(piece.query), uint32_t(piece.sequence), uint32_t(piece.first + x),
                      piece.scores[x]};
      if (cell.score < (piece.sequence == 0 ? 3U : 6U)) recognitions.push_back(cell);
      auto& kept = best[piece.query];
      if (!kept || cell.score < kept->score) kept = cell;
      maxima[piece.sequence] = std::max(maxima[piece.sequence], cell.score);
    }
  }
  for (const size_t threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    std::vector<ScanPiece> shuffled = pieces;
    RandomEngine engine(threads);
    for (size_t i = shuffled.size(); i > 1; --i)
      std::swap(shuffled[i - 1], shuffled[uniform_below(engine, i)]);
    RecognitionScan scan(scan_settings());
    MaximumScan maximum(2);
    parallel_for(shuffled.size(), {}, [&](size_t i) {
      scan(as_row(shuffled[i]));
      maximum(as_row(shuffled[i]));
    });
    const RecognitionScanResult result = scan.result();
    CHECK(result.recognitions == recognitions);
    CHECK(result.best == best);
    CHECK(maximum.result() == maxima);
  }
}

TEST_CASE("the maxima of no rows are 0") {
  CHECK(MaximumScan(3).result() == std::vector<uint32_t>{0, 0, 0});
}

TEST_CASE("more recognitions than the limit are an error with advice") {
  RecognitionScan scan(scan_settings(2));
  const std::string text = test::error_text([&] {
    scan({0, 1, 0, std::vector<uint32_t>{1, 1, 1}});
  });
  CHECK(test::has(text, "--t-r"));
}

TEST_CASE("selected cells are found in the pieces that contain them") {
  const std::vector<ScanPiece> pieces = random_pieces(2);
  std::vector<Cell> wanted = {{0, 0, 0, 0}, {0, 0, 49, 0}, {0, 1, 8, 0}, {19, 0, 25, 0}};
  CellScan scan(wanted);
  for (const ScanPiece& piece : pieces) scan(as_row(piece));
  for (const Cell& cell : scan.result()) {
    for (const ScanPiece& piece : pieces) {
      if (piece.query != cell.query_window || piece.sequence != cell.sequence) continue;
      if (cell.train_window < piece.first || cell.train_window >= piece.first + piece.scores.size())
        continue;
      CHECK(cell.score == piece.scores[cell.train_window - piece.first]);
    }
  }
}
