// Paths of the filter, computed by hand and compared with the reference implementation.
#include "match/filter_track.h"

#include <algorithm>
#include <map>
#include <numeric>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "match/score_kernels.h"
#include "reference/reference_filter.h"

using namespace vpr;

namespace {

// The distance of a keyframe to any place; 0 if it is unknown.
auto at(uint32_t distance) {
  return [distance](size_t) { return distance; };
}

/// Two sequences of 80 and 30 places, two frames each.
struct Places {
  FilterState state;
  PathTrack track;

  Places() {
    track.typical_distance = 100;
    for (const auto& [sequence, count] : {std::pair<size_t, size_t>{0, 80}, {1, 30}}) {
      state.cells.frames.resize(state.cells.size() + kLongestStep, 0);
      const size_t first_frame = sequence * 160;
      state.cells.runs.push_back({state.cells.size(), count, sequence, first_frame + 2 * count});
      for (size_t i = 0; i < count; ++i)
        state.cells.frames.push_back(static_cast<uint32_t>(first_frame + 2 * i));
    }
    add_decoys(state.cells);
    state.values.assign(state.cells.size(), kNoValue);
    state.earlier.assign(track.settings.path_keyframes / 2, state.values);
  }

  size_t cell(size_t sequence, size_t place) const {
    return state.cells.runs[sequence].first + place;
  }

  // The same place in the other direction.
  size_t decoy(size_t sequence, size_t place) const {
    return state.cells.size() - 1 - cell(sequence, place) + kLongestStep;
  }

  // Places 40 to 79 of the first sequence are another pass through places 0 to 39.
  void add_second_pass() {
    state.cells.first_passes.resize(state.cells.decoys);
    std::iota(state.cells.first_passes.begin(), state.cells.first_passes.end(), 0U);
    for (size_t place = 40; place < 80; ++place)
      state.cells.first_passes[cell(0, place)] = static_cast<uint32_t>(cell(0, place - 40));
  }

  // The next keyframe, without evidence.
  void advance() {
    std::rotate(state.earlier.begin(), state.earlier.end() - 1, state.earlier.end());
    state.earlier.front() = state.values;
    for (const CellStretch& run : state.cells.runs)
      std::fill_n(state.values.begin() + static_cast<ptrdiff_t>(run.first), run.count,
                  kNewPathValue + 2 * kScoreUnit);
  }

  void see(size_t sequence, size_t place, size_t query_frame, uint32_t evidence = 24 * kScoreUnit,
           uint32_t distance = 0) {
    advance();
    state.values[cell(sequence, place)] = kNewPathValue - evidence;
    follow_keyframe(track, state, query_frame, at(distance));
  }

  size_t open() const { return open_keyframes(track); }
  size_t length() const { return track.recent.back().length; }
  uint32_t number() const { return track.recent.back().path; }
};

}  // namespace

TEST_CASE("a path has a margin from its 16th keyframe on, for as long as it continues") {
  Places places;
  for (size_t view = 0; view < 29; ++view) {
    places.see(0, view, view);
    INFO(view);
    CHECK(places.track.margin == (view >= 15 ? 24 * kScoreUnit : 0));
    CHECK(places.open() == std::min<size_t>(view + 1, 8));
  }
  places.see(0, 39, 29);  // a jump of 11 places is another path, 10 would not be
  CHECK(places.track.margin == 0);
  CHECK(places.length() == 1);
  CHECK(places.number() == 2);
}

TEST_CASE("a place with less evidence than a new path has no margin") {
  Places places;
  for (size_t view = 0; view < 20; ++view) places.see(0, view, view);
  places.advance();
  places.state.values[places.cell(0, 20)] = kNewPathValue + kScoreUnit;
  follow_keyframe(places.track, places.state, 20, at(0));
  CHECK(places.length() == 21);
  CHECK(places.track.margin == 0);
}

TEST_CASE("the farther a path, the more keyframes must advance, and the smaller its margin") {
  const auto margin_at = [](size_t advancing, uint32_t distance) {
    Places places;
    size_t place = 5;
    for (size_t view = 0; view < 16; ++view) {
      if (view > 0 && view <= advancing) ++place;
      places.see(0, place, view, 10 * kScoreUnit, distance);
    }
    return places.track.margin;
  };
  CHECK(margin_at(3, 50) == 0);
  CHECK(margin_at(4, 50) == 10 * kScoreUnit);
  CHECK(margin_at(7, 66) == 0);
  CHECK(margin_at(8, 65) == 8 * kScoreUnit);
  CHECK(margin_at(11, 80) == 0);
  CHECK(margin_at(12, 80) == 6 * kScoreUnit);
  CHECK(margin_at(15, 105) == 6 * kScoreUnit);
  CHECK(margin_at(15, 106) == 0);
}

TEST_CASE("the same places in the other direction compete, however near, and have a path as well") {
  Places places;
  PathTrack reversed = places.track;
  reversed.follows_decoys = true;
  for (size_t view = 0; view < 20; ++view) {
    places.advance();
    places.state.values[places.cell(0, 10 + view)] = kNewPathValue - 9 * kScoreUnit;
    places.state.values[places.decoy(0, 29 - view)] = kNewPathValue - 24 * kScoreUnit;
    for (PathTrack* track : {&places.track, &reversed})
      follow_keyframe(*track, places.state, view, at(0));
  }
  CHECK(places.track.recent.back().cell == places.cell(0, 29));
  CHECK(places.track.margin == 0);
  CHECK(reversed.recent.back().length == 20);
  CHECK(reversed.recent.back().cell == places.decoy(0, 10));
  CHECK(reversed.margin == 15 * kScoreUnit);
}

TEST_CASE("places are traced back from the last keyframe, by steps, over eight keyframes") {
  Places places;
  for (size_t view = 0; view < 10; ++view) places.see(0, view, view);
  // Keyframe 10 has two likely places, and the better one is not on the way to the next keyframe.
  places.advance();
  places.state.values[places.cell(0, 18)] = kNewPathValue - 25 * kScoreUnit;
  places.state.values[places.cell(0, 10)] = kNewPathValue - 24 * kScoreUnit;
  follow_keyframe(places.track, places.state, 10, at(0));
  CHECK(places.track.recent.back().cell == places.cell(0, 18));
  for (size_t view = 11; view < 18; ++view) {
    places.see(0, view, view);
    const PathKeyframe& traced =
        *(places.track.recent.rbegin() + static_cast<ptrdiff_t>(view - 10));
    CHECK(traced.frame == 10);
    CHECK(traced.cell == places.cell(0, 10));
    CHECK(traced.value == kNewPathValue - 24 * kScoreUnit);
  }
}

TEST_CASE("a path begins where it advances, with three keyframes at its first place") {
  const auto first_frame = [](const auto& place_of) {
    Places places;
    for (size_t view = 0; view < 36; ++view) places.see(0, place_of(view), view);
    return places.track.first_frame;
  };
  CHECK(first_frame([](size_t view) { return view; }) == 0);
  CHECK(first_frame([](size_t view) { return view / 2; }) == 0);
  CHECK(first_frame([](size_t view) { return view < 12 ? 0 : view - 11; }) == 9);
  // A step back to place 1, before which eight keyframes are traced back to it.
  CHECK(first_frame([](size_t view) { return view < 9 ? 6 + view % 2 : view - 8; }) == 6);
  // A stop on the way does not begin a path.
  CHECK(first_frame(
            [](size_t view) { return view < 16 ? view : std::max<size_t>(15, view - 8); }) == 0);
}

TEST_CASE("paths of few keyframes begin at once") {
  for (const uint64_t keyframes : {0, 1, 2, 3, 6}) {
    Places places;
    places.track.settings.path_keyframes = keyframes;
    for (size_t view = 0; view < 8; ++view) places.see(0, view, view, 4 * kScoreUnit);
    INFO(keyframes);
    CHECK(places.track.first_frame == places.track.recent.front().frame);
  }
}

TEST_CASE("a path that is not established resumes after another one led for a while") {
  const auto interrupt = [](size_t seen, size_t keyframes, uint32_t evidence) {
    Places places;
    for (size_t view = 0; view < seen; ++view) places.see(0, view, view, evidence);
    for (size_t view = seen; view < seen + keyframes; ++view) {
      places.advance();
      places.state.values[places.cell(0, view)] = kNewPathValue - 2 * kScoreUnit;
      places.state.values[places.cell(1, view)] = kNewPathValue - 3 * kScoreUnit;
      follow_keyframe(places.track, places.state, view, at(0));
      CHECK(places.length() == view - seen + 1);
      CHECK(places.number() == 2);
    }
    for (size_t view = seen + keyframes; view < seen + keyframes + 16; ++view)
      places.see(0, view, view);
    return places;
  };
  const Places resumed = interrupt(5, 7, 3 * kScoreUnit);
  CHECK(resumed.number() == 1);
  CHECK(resumed.length() == 28);
  CHECK(resumed.track.first_frame == 0);
  CHECK(resumed.track.recent[8].cell == resumed.cell(0, 8));
  const Places too_late = interrupt(5, 8, 3 * kScoreUnit);
  CHECK(too_late.number() == 3);
  CHECK(too_late.length() == 16);
  CHECK(too_late.track.first_frame == 13);
  // A margin of 5 deviations at the 16th keyframe establishes a path.
  CHECK(interrupt(16, 1, 5 * kScoreUnit - 1).number() == 1);
  CHECK(interrupt(16, 1, 5 * kScoreUnit).number() == 3);
}

TEST_CASE("a path recognizes 65 keyframes until it has been established for 25, then 25") {
  Places places;
  for (size_t view = 0; view < 120; ++view) {
    const size_t place = std::min<size_t>(view / 2, 39);
    places.see(0, place, view, view < 80 ? 4 * kScoreUnit : 24 * kScoreUnit);
    INFO(view);
    const size_t kept = view < 80 + 24 ? 64 : 24;
    CHECK(places.track.first_frame == view - std::min(view, kept));
  }
}

TEST_CASE("paths equal the reference implementation") {
  size_t with_margin = 0;
  size_t implausible = 0;
  size_t traced = 0;
  size_t resumed = 0;
  for (uint64_t seed = 1; seed <= 30; ++seed) {
    Places places;
    RandomEngine engine(seed);
    places.track.follows_decoys = seed % 2 == 0;
    if (seed % 3 > 0) places.add_second_pass();
    const PathTrack start = places.track;
    const auto followed = [&](size_t sequence, size_t place) {
      return places.track.follows_decoys ? places.decoy(sequence, 29 - place)
                                         : places.cell(sequence, place);
    };
    std::vector<std::vector<uint32_t>> values;
    std::vector<uint32_t> distances;
    std::vector<ReferenceKeyframe> found;
    std::map<size_t, size_t> cells;  // by keyframe
    size_t highest = 0;              // number of a path
    size_t sequence = 0;
    size_t place = 0;
    for (size_t view = 0; view < 120; ++view) {
      if (uniform_below(engine, 60) == 0) sequence = uniform_below(engine, 2);
      place = uniform_below(engine, 40) == 0
                  ? uniform_below(engine, 30)
                  : std::min<size_t>(place + uniform_below(engine, 2), 29);
      places.advance();
      for (const CellStretch& run : places.state.cells.runs)
        for (size_t cell = run.first; cell < run.first + run.count; ++cell)
          places.state.values[cell] = kNewPathValue +
                                      static_cast<uint32_t>(uniform_below(engine, 6)) * kScoreUnit -
                                      2 * kScoreUnit;
      const size_t wrong = uniform_below(engine, 4);
      places.state.values[followed(sequence, place)] = kNewPathValue - 9 * kScoreUnit;
      places.state.values[followed(sequence, std::min<size_t>(place + wrong, 29))] =
          kNewPathValue - (9 + static_cast<uint32_t>(uniform_below(engine, 9))) * kScoreUnit;
      distances.push_back(static_cast<uint32_t>(uniform_below(engine, 140)));
      follow_keyframe(places.track, places.state, view, at(distances.back()));
      values.push_back(places.state.values);
      found.push_back({places.number(), places.track.margin, 0});
      resumed += places.length() > 1 && found.size() > 1 && found.back().path < highest;
      highest = std::max(highest, found.back().path);
      for (const PathKeyframe& keyframe : places.track.recent)
        cells[keyframe.frame] = keyframe.cell;
      traced += cells[view] != followed(sequence, place);
    }
    const std::vector<ReferenceKeyframe> expected =
        reference_paths(places.state.cells, values, distances, start);
    for (size_t view = 0; view < found.size(); ++view) {
      INFO("seed " << seed << ", view " << view);
      REQUIRE(found[view].path == expected[view].path);
      REQUIRE(found[view].margin == expected[view].margin);
      REQUIRE(cells[view] == expected[view].cell);
      with_margin += found[view].margin > 0;
      implausible += view > 30 && found[view].margin == 0;
    }
  }
  CHECK(with_margin > 100);
  CHECK(implausible > 100);
  CHECK(traced > 100);
  CHECK(resumed > 50);
}

TEST_CASE("passes of one place do not compete, except for decoys, and the path stays in its pass") {
  const auto follow = [](uint32_t evidence, bool has_passes) {
    Places places;
    if (has_passes) places.add_second_pass();
    for (size_t view = 0; view < 20; ++view) {
      places.advance();
      places.state.values[places.cell(0, view)] = kNewPathValue - 20 * kScoreUnit;
      places.state.values[places.cell(0, 40 + view)] =
          kNewPathValue - (view < 17 ? 19 * kScoreUnit : evidence);
      places.state.values[places.decoy(0, 40 + view)] = kNewPathValue - 12 * kScoreUnit;
      follow_keyframe(places.track, places.state, view, at(0));
    }
    return places;
  };
  CHECK(follow(25 * kScoreUnit, false).track.margin == 0);  // of a new path
  const Places same = follow(25 * kScoreUnit, true);
  CHECK(same.track.recent.back().cell == same.cell(0, 19));
  CHECK(same.track.margin == 8 * kScoreUnit);
  CHECK(same.number() == 1);
  const Places other = follow(25 * kScoreUnit + 1, true);
  CHECK(other.track.recent.back().cell == other.cell(0, 59));
  CHECK(other.track.margin == 13 * kScoreUnit + 1);  // its own decoy
  CHECK(other.number() == 2);
  CHECK(other.length() == 20);
  CHECK(*recent_rate(other.track, other.state.cells) == 2);  // 9 keyframes, traced back
}

TEST_CASE("other passes of a place end 20 keyframes away, its own one 10 keyframes away") {
  const auto margin_with = [](size_t best, size_t place) {
    Places places;
    places.add_second_pass();
    for (size_t view = 0; view < 16; ++view) {
      places.advance();
      places.state.values[places.cell(0, best + view - 15)] = kNewPathValue - 24 * kScoreUnit;
      places.state.values[places.cell(0, place)] = kNewPathValue - 14 * kScoreUnit;
      follow_keyframe(places.track, places.state, view, at(0));
    }
    return places.track.margin;
  };
  CHECK(margin_with(60, 0) == 24 * kScoreUnit);
  CHECK(margin_with(61, 0) == 10 * kScoreUnit);
  CHECK(margin_with(20, 79) == 24 * kScoreUnit);
  CHECK(margin_with(18, 79) == 10 * kScoreUnit);
  CHECK(margin_with(60, 50) == 24 * kScoreUnit);
  CHECK(margin_with(60, 49) == 10 * kScoreUnit);
}

TEST_CASE("places near the best one, or of an overlapping sequence, are in the exclusion zone") {
  Places places;
  const auto margin_with = [&](size_t sequence, size_t place) {
    for (size_t view = 0; view < 20; ++view) places.see(0, view, view, 9 * kScoreUnit);
    places.advance();
    places.state.values[places.cell(0, 20)] = kNewPathValue - 24 * kScoreUnit;
    places.state.values[places.cell(sequence, place)] = kNewPathValue - 14 * kScoreUnit;
    follow_keyframe(places.track, places.state, 20, at(0));
    return places.track.margin;
  };
  CHECK(margin_with(0, 10) == 24 * kScoreUnit);
  CHECK(margin_with(0, 9) == 10 * kScoreUnit);
  CHECK(margin_with(0, 30) == 24 * kScoreUnit);
  CHECK(margin_with(0, 31) == 10 * kScoreUnit);
  CHECK(margin_with(1, 3) == 10 * kScoreUnit);
  places.track.overlapping = {{0, 1}, {1, 0}};
  CHECK(margin_with(1, 3) == 24 * kScoreUnit);
}

TEST_CASE("within a keyframe, the position advances at the rate, up to its end") {
  Places places;
  const FilterCells& cells = places.state.cells;
  places.see(0, 0, 0);
  CHECK_FALSE(recent_rate(places.track, cells));
  for (size_t view = 1; view < 7; ++view) places.see(0, view, 8 * view);
  CHECK(*recent_rate(places.track, cells) == 0.25);
  const PathKeyframe keyframe = places.track.recent.back();  // query frame 48, training frame 12
  CHECK(position_at(cells, keyframe, 49, 0.25) == 12);
  CHECK(position_at(cells, keyframe, 50, 0.25) == 13);
  CHECK(position_at(cells, keyframe, 58, 0.25) == 13);
  const PathKeyframe last{60, places.cell(1, 29), 0};  // the last keyframe of all
  CHECK(position_at(cells, last, 60, 1) == 218);
  CHECK(position_at(cells, last, 90, 1) == 219);
}
