// The method filter on sequences.
#include <map>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "examples.h"
#include "match/distance_statistics.h"
#include "match/filter_track.h"
#include "match/match.h"
#include "match/score_kernels.h"
#include "match/zscores.h"
#include "support.h"

using namespace vpr;

namespace {

constexpr uint32_t kUnit = kScoreUnit;

struct FilterRun {
  std::map<size_t, PathReport> reports;  ///< by query frame, without matches
  std::map<size_t, Cell> matches;        ///< by query frame
  std::map<size_t, uint32_t> paths;      ///< of the matches
  std::map<size_t, uint32_t> margins;    ///< the largest one since the match is settled
  std::map<size_t, Cell> positions;      ///< when the frame arrived
  std::map<size_t, Cell> best;           ///< the best cell of the row
  test::Cells cells;
};

FilterRun run_filter(const test::Example& example) {
  const std::vector<DescribedFrames> spans = example.spans();
  const TrainStatistics statistics = compute_statistics(spans, {}, {});
  const ScoreBasis basis = make_score_basis(statistics);
  FilterRun found;
  MatchSettings settings{1, size_t{1} << 30};
  settings.method = &find_sequence_method("filter");
  const auto collect = [&](const ScoreRow& row) {
    if (!found.reports.contains(row.query_window)) {
      found.reports[row.query_window] = *row.path;
      found.reports[row.query_window].matches = {};
      for (const Cell& match : row.path->matches) {
        found.matches[match.query_window] = match;
        found.paths[match.query_window] = row.path->path;
      }
      found.positions[row.query_window] = row.path->matches.back();
    }
    for (size_t x = 0; x < row.scores.size(); ++x)
      REQUIRE(found.cells
                  .emplace(test::CellKey{row.query_window, row.sequence, row.train_window + x},
                           row.scores[x])
                  .second);
  };
  match(zscores(frame_distances(spans, {example.query, example.query_unreadable}), basis), settings,
        {{collect}}, {});
  for (const auto& [key, value] : found.cells) {
    const auto& [query, sequence, train] = key;
    if (!found.best.contains(query) || value < found.best[query].score)
      found.best[query] = {static_cast<uint32_t>(query), static_cast<uint32_t>(sequence),
                           static_cast<uint32_t>(train), value};
  }
  CHECK(found.best == found.positions);
  for (const auto& [query, report] : found.reports)
    for (const auto& [frame, settled] : found.matches)
      if (frame >= report.first && frame < report.settled && found.paths[frame] == report.path)
        found.margins[frame] = std::max(found.margins[frame], report.margin);
  return found;
}

// A code of the sequence with some bits changed.
LdbCode with_changed_bits(LdbCode code, RandomEngine& engine) {
  for (int i = 0; i < 30; ++i) {
    const uint64_t bit = uniform_below(engine, kLdbBits);
    code[bit / 8] = static_cast<uint8_t>(code[bit / 8] ^ 1 << bit % 8);
  }
  return code;
}

}  // namespace

TEST_CASE("a route is recognized at half and at double speed, and off-map frames are not") {
  test::Example example;
  example.train = {test::walk_codes(200, 1), test::walk_codes(150, 2)};
  example.train_unreadable.resize(2);
  for (const double pace : {0.5, 1.0, 2.0}) {
    INFO("pace " << pace);
    RandomEngine engine(4);
    example.query.clear();
    std::vector<size_t> truth;
    for (size_t k = 0; static_cast<double>(k) * pace < 110; ++k) {
      truth.push_back(static_cast<size_t>(static_cast<double>(k) * pace) + 60);
      example.query.push_back(with_changed_bits(example.train[0][truth.back()], engine));
    }
    const size_t on_map = truth.size();
    for (const LdbCode& code : test::walk_codes(60, 77)) example.query.push_back(code);
    const FilterRun found = run_filter(example);
    CHECK(found.cells.size() == example.query.size() * 350);
    size_t recognized = 0;
    for (const auto& [query, margin] : found.margins) {
      if (margin < 15 * kUnit) continue;
      ++recognized;
      REQUIRE(query < on_map);
      REQUIRE(found.matches.at(query).sequence == 0);
      const auto off = static_cast<double>(found.matches.at(query).train_window) -
                       static_cast<double>(truth[query]);
      REQUIRE(std::abs(off) <= 4);
    }
    CHECK(recognized >= on_map / 2);
    CHECK(*found.reports.at(on_map - 1).rate == Approx(pace).epsilon(0.2));
  }
}

TEST_CASE("unreadable frames have no rows and reset the filter") {
  test::Example example = test::make_example({60, 1, 45}, 50, 3);
  example.train_unreadable[0] = {0, 30};
  example.train_unreadable[1] = {0};
  example.query_unreadable = {0, 20, 49};
  const FilterRun found = run_filter(example);
  CHECK(found.reports.size() == 47);
  CHECK(found.cells.size() == 47 * (58 + 45));
  CHECK_FALSE(found.cells.contains({20, 0, 5}));
  CHECK_FALSE(found.cells.contains({5, 0, 30}));
  // The frame after the gap is a first frame.
  CHECK(found.reports.at(21).margin == 0);
  CHECK_FALSE(found.reports.at(21).rate);
}

TEST_CASE("one frame against one frame is a row of one value") {
  const FilterRun found = run_filter(test::make_example({1}, 1, 3));
  REQUIRE(found.cells.size() == 1);
  CHECK(found.reports.at(0).margin == 0);
}

TEST_CASE("unreadable training frames have no row") {
  test::Example example = test::make_example({2}, 3, 3);
  example.train_unreadable[0] = {0, 1};
  CHECK(run_filter(example).cells.empty());
}
