// When the filter is believed, worked out by hand; and the method filter on walks.
#include "matching/filter_track.h"

#include <map>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "base/simd.h"
#include "examples.h"
#include "matching/distance_statistics.h"
#include "matching/match_filter.h"
#include "matching/score_kernels.h"
#include "matching/standardized_frames.h"
#include "support.h"

using namespace vpr;

namespace {

constexpr uint32_t kUnit = kScoreUnit;

/// Two sequences of 40 and 30 places, two frames each; nothing is believed of any of them.
struct Places {
  FilterState state;
  PathTrack track;
  std::vector<uint16_t> scores;

  Places() {
    for (const auto& [sequence, count] : {std::pair<size_t, size_t>{0, 40}, {1, 30}}) {
      state.cells.frames.resize(state.cells.size() + kLongestStep, 0);
      const size_t first_frame = sequence * 80;
      state.cells.runs.push_back({state.cells.size(), count, sequence, first_frame + 2 * count});
      for (size_t i = 0; i < count; ++i)
        state.cells.frames.push_back(static_cast<uint32_t>(first_frame + 2 * i));
    }
    state.values.assign(state.cells.size(), kNoValue);
    track.kernels = select_kernels();
    scores.assign(140, static_cast<uint16_t>(kScoreBias - 2 * kUnit));  // z = -2
    forget();
  }

  void forget() {
    for (const CellRun& run : state.cells.runs)
      std::fill_n(state.values.begin() + static_cast<ptrdiff_t>(run.first), run.count,
                  kScoreBias + 30 * kUnit);
    state.nowhere_value = kScoreBias + 25 * kUnit;
  }

  size_t cell(size_t sequence, size_t place) const {
    return state.cells.runs[sequence].first + place;
  }

  void see(size_t sequence, size_t place, size_t query_frame) {
    forget();
    state.values[cell(sequence, place)] = kScoreBias + kUnit;
    follow_view(track, state, scores, query_frame);
  }
};

}  // namespace

TEST_CASE("a path is believed after 18 views, and as long as it goes on") {
  Places places;
  for (size_t view = 0; view < 30; ++view) {
    places.see(0, view, view);
    INFO(view);
    // Views of the query and of the training sequence that were passed: 2 view + 1 of 36.
    CHECK(places.track.last.margin == (view >= 18 ? 24 * kUnit : 0));
    CHECK(places.track.last.nowhere == kScoreBias + 25 * kUnit);
  }
  places.see(0, 38, 30);  // 9 places on is another path, 8 would not be
  CHECK(places.track.last.margin == 0);
  CHECK(places.track.views == 1);
}

TEST_CASE("who stands still needs twice as many views of his own") {
  Places places;
  for (size_t view = 0; view < 40; ++view) {
    places.see(0, 5, view);
    CHECK((places.track.last.margin > 0) == (view >= 35));
  }
}

TEST_CASE("a path that its frames do not support is not believed, and given up") {
  Places places;
  for (size_t view = 0; view < 20; ++view) places.see(0, view, view);
  REQUIRE(places.track.last.margin > 0);
  std::fill(places.scores.begin(), places.scores.end(), kScoreBias);  // support 2 * (1 - 2^-20)
  places.see(0, 20, 20);
  CHECK(places.track.last.margin == 0);  // just below 1
  CHECK(places.track.is_established);
  std::fill(places.scores.begin(), places.scores.end(),
            static_cast<uint16_t>(kScoreBias + 2 * kUnit));
  places.see(0, 21, 21);
  CHECK_FALSE(places.track.is_established);
}

TEST_CASE("what is near the best place, or the same one, is not elsewhere") {
  Places places;
  const auto margin_with = [&](size_t sequence, size_t place) {
    for (size_t view = 0; view < 20; ++view) places.see(0, view, view);
    places.forget();
    places.state.values[places.cell(0, 20)] = kScoreBias + kUnit;
    places.state.values[places.cell(sequence, place)] = kScoreBias + 3 * kUnit;
    follow_view(places.track, places.state, places.scores, 20);
    return places.track.last.margin;
  };
  CHECK(margin_with(0, 12) == 24 * kUnit);
  CHECK(margin_with(0, 11) == 2 * kUnit);
  CHECK(margin_with(0, 28) == 24 * kUnit);
  CHECK(margin_with(0, 29) == 2 * kUnit);
  CHECK(margin_with(1, 3) == 2 * kUnit);
  places.track.shared = {{0, 1}, {1, 0}};
  CHECK(margin_with(1, 3) == 24 * kUnit);
}

TEST_CASE("within a view the query goes on at its rate, to its end") {
  Places places;
  places.see(0, 0, 0);
  const auto frame_at = [&](size_t query_frame) {
    return path_at(places.track, places.state.cells, query_frame).frame;
  };
  CHECK_FALSE(places.track.last.rate);
  CHECK(frame_at(0) == 0);
  CHECK(frame_at(1) == 1);
  CHECK(frame_at(9) == 1);
  for (size_t view = 1; view < 7; ++view) places.see(0, view, 8 * view);
  CHECK(*places.track.last.rate == 0.25);
  CHECK(frame_at(49) == 12);
  CHECK(frame_at(50) == 13);
  places.see(1, 29, 60);  // the last view of all
  CHECK(frame_at(60) == 138);
  CHECK(frame_at(90) == 139);
}

namespace {

struct Believed {
  std::map<size_t, PathReport> reports;  ///< by query frame
  std::map<size_t, size_t> best;         ///< by query frame, among all training frames
  test::Cells cells;
};

Believed believed(const test::Example& example) {
  const std::vector<DescriptorSpan> spans = example.spans();
  const TrainStatistics statistics = compute_statistics(spans, {}, {});
  const ScoreBasis basis = make_score_basis({}, false, statistics);
  Believed found;
  MatchSettings settings{1, size_t{1} << 30, select_kernels()};
  settings.on_path = [&](const PathReport& report) { found.reports[report.query_frame] = report; };
  match_filter(
      standardized(frame_distances(spans, {example.query, example.query_unreadable}), basis, {}),
      settings, {}, [&](const ScoreRow& row) {
        for (size_t x = 0; x < row.scores.size(); ++x)
          REQUIRE(found.cells
                      .emplace(test::CellKey{row.query_window, row.sequence, row.train_window + x},
                               row.scores[x])
                      .second);
      });
  std::map<size_t, uint32_t> least;
  for (const auto& [key, value] : found.cells) {
    const auto& [query, sequence, train] = key;
    size_t frame = train;
    for (size_t s = 0; s < sequence; ++s) frame += example.train[s].size();
    if (!least.contains(query) || value < least[query]) {
      least[query] = value;
      found.best[query] = frame;
    }
  }
  return found;
}

// A code of the walk, with some bits changed.
LdbCode seen_again(LdbCode code, RandomEngine& engine) {
  for (int i = 0; i < 30; ++i) {
    const uint64_t bit = uniform_below(engine, kLdbBits);
    code[bit / 8] = static_cast<uint8_t>(code[bit / 8] ^ 1 << bit % 8);
  }
  return code;
}

}  // namespace

TEST_CASE("a walk is found at half its pace, at twice its pace, and nowhere off the map") {
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
      example.query.push_back(seen_again(example.train[0][truth.back()], engine));
    }
    const size_t on_map = truth.size();
    for (const LdbCode& code : test::walk_codes(60, 77)) example.query.push_back(code);
    const Believed found = believed(example);
    CHECK(found.cells.size() == example.query.size() * 350);
    size_t trusted = 0;
    for (size_t query = 0; query < example.query.size(); ++query) {
      if (found.reports.at(query).margin < 3 * kUnit) continue;
      ++trusted;
      REQUIRE(query < on_map + 6);
      if (query >= on_map) continue;
      const auto off =
          static_cast<double>(found.best.at(query)) - static_cast<double>(truth[query]);
      REQUIRE(std::abs(off) <= 3);
    }
    CHECK(trusted >= on_map / 2);
    CHECK(*found.reports.at(on_map - 1).rate == Approx(pace).epsilon(0.2));
  }
}

TEST_CASE("frames that can't be read have no rows, and end what was known") {
  test::Example example = test::make_example({60, 1, 45}, 50, 3);
  example.train_unreadable[0] = {0, 30};
  example.train_unreadable[1] = {0};
  example.query_unreadable = {0, 20, 49};
  const Believed found = believed(example);
  CHECK(found.reports.size() == 47);
  CHECK(found.cells.size() == 47 * (58 + 45));
  CHECK_FALSE(found.cells.contains({20, 0, 5}));
  CHECK_FALSE(found.cells.contains({5, 0, 30}));
  // The frame behind the gap is a first one.
  test::Example rest = example;
  rest.query.erase(rest.query.begin(), rest.query.begin() + 21);
  rest.query_unreadable = {28};
  CHECK(found.reports.at(21).margin == 0);
  CHECK_FALSE(found.reports.at(21).rate);
}

TEST_CASE("one frame against one frame is a row of one value") {
  const Believed found = believed(test::make_example({1}, 1, 3));
  REQUIRE(found.cells.size() == 1);
  CHECK(found.reports.at(0).margin == 0);
}

TEST_CASE("training frames that can't be read at all give no row") {
  test::Example example = test::make_example({2}, 3, 3);
  example.train_unreadable[0] = {0, 1};
  CHECK(believed(example).cells.empty());
}
