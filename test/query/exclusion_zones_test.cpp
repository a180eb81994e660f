// Exclusion radii, and margins compared with the reference implementation.
#include "query/exclusion_zones.h"

#include <algorithm>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "reference/reference.h"
#include "support.h"

using namespace vpr;

namespace {

bool can_read(const DescribedFrames& walk, size_t frame) {
  return !std::binary_search(walk.unreadable.begin(), walk.unreadable.end(), frame);
}

// Means over all pairs of readable frames, and over those k apart.
size_t slow_radius(const DescribedFrames& walk) {
  const size_t frames = walk.rows.size();
  const auto mean = [&](const auto& is_pair) {
    double sum = 0;
    double count = 0;
    for (size_t i = 0; i < frames; ++i)
      for (size_t j = i + 1; j < frames; ++j) {
        if (!can_read(walk, i) || !can_read(walk, j) || !is_pair(i, j)) continue;
        sum += reference_hamming(walk.rows[i], walk.rows[j]);
        ++count;
      }
    return count == 0 ? -1 : sum / count;
  };
  const double typical = mean([](size_t, size_t) { return true; });
  for (size_t k = 1; k < frames; ++k)
    if (mean([&](size_t i, size_t j) { return j == i + k; }) >= typical / 2) return k;
  return frames;
}

}  // namespace

TEST_CASE("the exclusion zone extends to half of the average difference") {
  // Four frames of one place, then four of another one that differs in all bits of one or two
  // bytes.
  std::vector<LdbCode> codes(8, LdbCode{});
  for (size_t i = 4; i < 8; ++i) codes[i][0] = 0xff;
  // 16 of 28 pairs differ by 8 bits: 32/7 on average. 1, 2, 3 apart: 8/7, 16/6, 24/5 bits.
  CHECK(exclusion_radius({codes, {}}) == 2);
  CHECK(exclusion_radius({std::vector<LdbCode>(5, LdbCode{}), {}}) == 1);  // equal codes
  for (const int bits : {10, 60, 300}) {
    const auto walk = test::walk_codes(90, 4, bits);
    CHECK(exclusion_radius({walk, {}}) == slow_radius({walk, {}}));
  }
}

TEST_CASE("distances of points are sampled for the exclusion zone of a long sequence") {
  std::vector<int16_t> points;
  for (int i = 0; i < 30'000; ++i) {
    const int turn = i % 400;  // back and forth
    points.push_back(static_cast<int16_t>(50 * std::min(turn, 400 - turn)));
  }
  const DescriptorRows rows({ElementType::points16, 1},
                            {reinterpret_cast<const uint8_t*>(points.data()), 2 * points.size()});
  const size_t radius = exclusion_radius({rows.first(8000), {}});
  CHECK(radius > 20);
  CHECK(exclusion_radius({rows, {}}) == radius);
}

namespace {

/// Values of one row, by sequence and window; nullopt for a missing cell.
using FullRow = std::vector<std::vector<std::optional<uint32_t>>>;

// The reference implementation, from a whole row.
std::optional<uint32_t> slow_margin(const FullRow& row, const ExclusionZones& zones) {
  std::optional<Cell> best;
  for (size_t s = 0; s < row.size(); ++s)
    for (size_t i = 0; i < row[s].size(); ++i)
      if (row[s][i] && (!best || *row[s][i] < best->score))
        best = Cell{0, uint32_t(s), uint32_t(i), *row[s][i]};
  std::optional<uint32_t> smallest;
  for (size_t s = 0; best && s < row.size(); ++s)
    for (size_t i = 0; i < row[s].size(); ++i) {
      const size_t apart =
          std::max<size_t>(i, best->train_window) - std::min<size_t>(i, best->train_window);
      const bool is_outside =
          s == best->sequence ? apart > zones.widths[s] : zones.overlaps[s][best->sequence] == 0;
      if (row[s][i] && is_outside && (!smallest || *row[s][i] < *smallest)) smallest = row[s][i];
    }
  return smallest ? std::optional(*smallest - best->score) : std::nullopt;
}

struct Piece {
  size_t sequence = 0;
  size_t first = 0;
  std::vector<uint32_t> scores;
};

// A row like the rows of matchers: valleys in noise, ties (few different values) and holes.
FullRow random_row(RandomEngine& engine, const std::vector<size_t>& windows) {
  FullRow row;
  const size_t values = 2 + uniform_below(engine, 60);
  const bool has_holes = uniform_below(engine, 3) == 0;
  for (const size_t count : windows) {
    auto& cells = row.emplace_back(count);
    for (auto& cell : cells) cell = static_cast<uint32_t>(20 + uniform_below(engine, values));
    for (size_t valley = uniform_below(engine, 3); valley > 0 && count > 0; --valley) {
      const size_t at = uniform_below(engine, count);
      const size_t reach = 1 + uniform_below(engine, 12);
      for (size_t i = at - std::min(at, reach); i < std::min(count, at + reach); ++i) {
        const size_t apart = std::max(i, at) - std::min(i, at);
        cells[i] = std::min<uint32_t>(*cells[i], static_cast<uint32_t>(apart * 20 / reach));
      }
    }
    for (auto& cell : cells)
      if (has_holes && uniform_below(engine, 9) == 0) cell.reset();
  }
  return row;
}

// Cuts a row at missing cells and at random.
std::vector<Piece> pieces_of(const FullRow& row, size_t longest, RandomEngine& engine) {
  std::vector<Piece> pieces;
  for (size_t s = 0; s < row.size(); ++s) {
    size_t room = 0;
    for (size_t i = 0; i < row[s].size(); ++i) {
      if (!row[s][i]) {
        room = 0;
        continue;
      }
      if (room == 0) {
        pieces.push_back({s, i, {}});
        room = 1 + uniform_below(engine, longest);
      }
      pieces.back().scores.push_back(*row[s][i]);
      --room;
    }
  }
  return pieces;
}

void scan_pieces(MarginScan& scan, size_t query, const std::vector<Piece>& pieces) {
  std::vector<ScoreRow> row;
  for (const Piece& piece : pieces)
    row.push_back({query, piece.sequence, piece.first, piece.scores});
  if (!row.empty()) scan(row);
}

std::optional<uint32_t> scan_row(const std::vector<std::vector<uint32_t>>& row,
                                 const ExclusionZones& zones) {
  MarginScan scan(zones, 1);
  std::vector<Piece> pieces;
  for (size_t s = 0; s < row.size(); ++s)
    if (!row[s].empty()) pieces.push_back({s, 0, row[s]});
  scan_pieces(scan, 0, pieces);
  return scan.result()[0];
}

}  // namespace

TEST_CASE("the margin is the difference between the best value outside +-w and the best one") {
  const std::vector<std::vector<uint32_t>> row = {{9, 7, 4, 3, 5, 6, 8}};
  CHECK(scan_row(row, make_exclusion_zones({0}, {})) == 1);
  CHECK(scan_row(row, make_exclusion_zones({1}, {})) == 3);
  CHECK(scan_row(row, make_exclusion_zones({2}, {})) == 5);
}

TEST_CASE("a best match whose exclusion zone covers everything has no margin") {
  CHECK(scan_row({{9, 7, 4, 3, 5, 6, 8}}, make_exclusion_zones({3}, {})) == std::nullopt);
  CHECK(scan_row({{3}}, make_exclusion_zones({0}, {})) == std::nullopt);
  CHECK(scan_row({{}}, make_exclusion_zones({0}, {})) == std::nullopt);
}

TEST_CASE("runners-up are in sequences of other places only") {
  const std::vector<std::vector<uint32_t>> row = {{9, 9, 2, 9}, {3, 9, 9}, {5, 9}};
  CHECK(scan_row(row, make_exclusion_zones({1, 1, 1}, {})) == 1);
  CHECK(scan_row(row, make_exclusion_zones({1, 1, 1}, {{0, 1}})) == 3);
  CHECK(scan_row(row, make_exclusion_zones({1, 1, 1}, {{2, 0}, {0, 1}})) == 7);
}

TEST_CASE("the first of equal values is the best match, and its margin can be 0") {
  CHECK(scan_row({{5, 4, 4, 4}, {4, 4}}, make_exclusion_zones({1, 1}, {{0, 1}})) == 0);
  CHECK(scan_row({{5, 4, 4}, {4, 4}}, make_exclusion_zones({1, 1}, {{0, 1}})) == std::nullopt);
}

TEST_CASE("margins equal the reference implementation for rows cut into any pieces") {
  RandomEngine engine(7);
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<size_t> windows;
    std::vector<uint32_t> widths;
    std::vector<std::pair<size_t, size_t>> overlapping;
    for (size_t s = 1 + uniform_below(engine, 4); s > 0; --s) {
      for (size_t other = 0; other < windows.size(); ++other)
        if (uniform_below(engine, 2) == 0) overlapping.emplace_back(other, windows.size());
      windows.push_back(uniform_below(engine, 70));
      widths.push_back(static_cast<uint32_t>(uniform_below(engine, 15)));
    }
    const ExclusionZones zones = make_exclusion_zones(widths, overlapping);
    std::vector<FullRow> rows;
    for (int q = 0; q < 6; ++q) rows.push_back(random_row(engine, windows));
    MarginScan scan(zones, rows.size());
    for (size_t q = 0; q < rows.size(); ++q) {
      const size_t longest = 1 + uniform_below(engine, trial % 2 == 0 ? 6 : 60);
      scan_pieces(scan, q, pieces_of(rows[q], longest, engine));
    }
    for (size_t q = 0; q < rows.size(); ++q) {
      INFO("trial " << trial << ", row " << q);
      CHECK(scan.result()[q] == slow_margin(rows[q], zones));
    }
  }
}
