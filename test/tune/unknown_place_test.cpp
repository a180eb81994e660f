// Margins of query windows without their place.
#include <catch2/catch.hpp>

#include "base/random.h"
#include "tune/sweep.h"

using namespace vpr;

namespace {

constexpr size_t kLength = 3;  // frames of a window

GroundTruth truth_of(std::vector<std::vector<GroundTruth::Pair>> pairs, int64_t tolerance) {
  GroundTruth truth;
  truth.pairs = std::move(pairs);
  truth.tolerance_frames = tolerance;
  return truth;
}

// Passes rows of one sequence in pieces of `piece` cells.
std::vector<std::optional<uint32_t>> scan_rows(const GroundTruth& truth, uint32_t width,
                                               const std::vector<std::vector<uint32_t>>& rows,
                                               size_t piece) {
  const ExclusionZones zones = make_exclusion_zones({width}, {});
  UnknownPlaceScan scan(truth, zones, kLength, rows.size());
  for (size_t query = 0; query < rows.size(); ++query) {
    std::vector<ScoreRow> row;
    for (size_t first = 0; first < rows[query].size(); first += piece) {
      const size_t count = std::min(piece, rows[query].size() - first);
      row.push_back({query, 0, first, std::span(rows[query]).subspan(first, count)});
    }
    scan(row);
  }
  return scan.result();
}

// Reference implementation: labels of single cells, and all pairs of cells that are far enough
// apart.
std::optional<uint32_t> slow(const GroundTruth& truth, uint32_t width, size_t query,
                             const std::vector<uint32_t>& row) {
  const auto label = [&](size_t frame) { return truth.label(query + kLength - 1, 0, frame); };
  std::optional<uint32_t> found;
  std::vector<size_t> open;  // windows away from the place
  for (size_t i = 0; i < row.size(); ++i) {
    const size_t anchor = i + kLength - 1;
    bool is_near = false;
    for (size_t f = 0; f < row.size() + kLength - 1 + width; ++f)
      if (label(f) != PlaceLabel::different && std::max(f, anchor) - std::min(f, anchor) <= width)
        is_near = true;
    if (!is_near) open.push_back(i);
  }
  if (open.empty()) return found;
  size_t best = open.front();
  for (const size_t i : open)
    if (row[i] < row[best]) best = i;
  for (const size_t i : open)
    if (std::max(i, best) - std::min(i, best) > width && (!found || row[i] - row[best] < *found))
      found = row[i] - row[best];
  return found;
}

}  // namespace

TEST_CASE("the margin of a row excludes its place") {
  // The window ends at query frame 2, which shows training frame 4; windows end at frames 2 to 9.
  const GroundTruth truth = truth_of({{}, {}, {{0, 4, PlaceLabel::same}}}, 0);
  const std::vector<std::vector<uint32_t>> rows = {{50, 40, 3, 9, 60, 20, 21, 70}};
  for (const size_t piece : {8, 3, 1}) {
    // Frames 3 to 5 are excluded: of 50, 60, 20, 21, 70 the best is 20; the runner-up is 50.
    CHECK(scan_rows(truth, 1, rows, piece).front() == 30u);
  }
}

TEST_CASE("the place of an ignored pair is excluded as well") {
  const GroundTruth truth =
      truth_of({{}, {}, {{0, 2, PlaceLabel::ignore, 1}, {0, 4, PlaceLabel::same}}}, 0);
  CHECK(scan_rows(truth, 0, {{1, 2, 30, 10, 17}}, 5).front() == 7u);
}

TEST_CASE("a database with only this place has no margin without it") {
  const GroundTruth truth = truth_of({{}, {}, {{0, 2, PlaceLabel::same, 4}}}, 0);
  CHECK_FALSE(scan_rows(truth, 1, {{1, 2, 3, 4, 5}}, 2).front());
}

TEST_CASE("margins without the place equal the reference implementation, for any pieces of rows") {
  RandomEngine engine(3);
  for (int trial = 0; trial < 60; ++trial) {
    const size_t queries = 4;
    std::vector<std::vector<GroundTruth::Pair>> pairs(queries + kLength - 1);
    for (auto& row : pairs)
      for (uint32_t frame = 0; frame < 30; frame += 1 + uint32_t(uniform_below(engine, 20)))
        row.push_back(
            {0, frame, uniform_below(engine, 2) == 0 ? PlaceLabel::same : PlaceLabel::ignore});
    const GroundTruth truth = truth_of(pairs, int64_t(uniform_below(engine, 3)));
    const auto width = static_cast<uint32_t>(uniform_below(engine, 4));
    std::vector<std::vector<uint32_t>> rows(queries, std::vector<uint32_t>(28));
    for (auto& row : rows)
      for (uint32_t& score : row) score = static_cast<uint32_t>(uniform_below(engine, 50));
    const auto found = scan_rows(truth, width, rows, 1 + uniform_below(engine, 28));
    for (size_t query = 0; query < queries; ++query)
      REQUIRE(found[query] == slow(truth, width, query, rows[query]));
  }
}
