// Confirmation of tracks, computed by hand and compared with the reference implementation.
#include "match/filter_track.h"

#include <algorithm>

#include <catch2/catch.hpp>

#include "base/random.h"
#include "match/score_kernels.h"
#include "reference/plain_filter.h"

using namespace vpr;

namespace {

constexpr uint32_t kUnit = kScoreUnit;

/// Two sequences of 40 and 30 places, two frames each.
struct Places {
  FilterState state;
  PathTrack track;
  double z = -2;
  std::vector<int32_t> supports;
  double change = 0.25;  ///< as in the training sequence

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
    forget();
  }

  void forget() {
    for (const CellRun& run : state.cells.runs)
      std::fill_n(state.values.begin() + static_cast<ptrdiff_t>(run.first), run.count,
                  kScoreBias + 60 * kUnit);
    state.nowhere_value = kScoreBias + 25 * kUnit;
  }

  size_t cell(size_t sequence, size_t place) const {
    return state.cells.runs[sequence].first + place;
  }

  /// The next keyframe of the query, with this margin over the off-map state.
  QueryKeyframe view(size_t query_frame, uint32_t margin) {
    const auto rescore_path = [this, margin](size_t, bool begins) {
      if (begins) supports.clear();
      supports.push_back(static_cast<int32_t>(-z * kUnit));
      if (supports.size() > kRescoredKeyframes) supports.erase(supports.begin());
      return RescoredPath{supports, margin};
    };
    return {query_frame, change, rescore_path, [](size_t, size_t) { return 0.25; }};
  }

  void see(size_t sequence, size_t place, size_t query_frame, uint32_t margin = 24 * kUnit) {
    forget();
    state.values[cell(sequence, place)] = kScoreBias + kUnit;
    follow_keyframe(track, state, view(query_frame, margin));
  }
};

}  // namespace

TEST_CASE("a track is confirmed after 18 keyframes, for as long as it continues") {
  Places places;
  for (size_t view = 0; view < 29; ++view) {
    places.see(0, view, view);
    INFO(view);
    // Keyframes of the query and passed keyframes of the training sequence: 2 view + 1 of 36.
    CHECK(places.track.last.margin == (view >= 18 ? 24 * kUnit : 0));
    CHECK(places.track.last.off_map == kScoreBias + 25 * kUnit);
  }
  places.see(0, 39, 29);  // a jump of 11 places is another path, 10 would not be
  CHECK(places.track.last.margin == 0);
  CHECK(places.track.views == 1);
}

TEST_CASE("a stationary query needs twice as many keyframes") {
  Places places;
  places.state.settings.confirm_evidence = 1000;
  for (size_t view = 0; view < 40; ++view) {
    places.see(0, 5, view);
    CHECK((places.track.last.margin > 0) == (view >= 35));
  }
}

TEST_CASE("a track with high evidence is confirmed earlier") {
  const auto first_confirmed = [](double z, uint32_t margin) {
    Places places;
    places.z = z;
    size_t view = 0;
    while (view < 40 && places.track.last.margin == 0) {
      places.see(0, view, view, margin);
      ++view;
    }
    return view;
  };
  CHECK(first_confirmed(-3.25, 8 * kUnit) == 8);    // 2 per keyframe
  CHECK(first_confirmed(-7, 8 * kUnit) == 6);       // the maximum of 3
  CHECK(first_confirmed(-7, 8 * kUnit - 1) == 37);  // by its length
  Places places;
  places.z = -4;
  for (size_t view = 0; view < 5; ++view) places.see(0, view, view);
  places.z = 3;  // the maximum of 3; evidence of 13.75 is 1.75 after four keyframes
  for (size_t view = 5; view < 9; ++view) places.see(0, view, view);
  CHECK(places.track.evidence == 7 * kUnit / 4);
  places.see(0, 9, 9);
  CHECK(places.track.evidence == 0);
}

TEST_CASE("a track of twice the length needs less margin") {
  const uint32_t enough = 6554;  // 0.8 of 8 deviations
  Places places;
  for (size_t view = 0; view < 40; ++view) {
    places.see(0, view, view, enough);
    INFO(view);
    CHECK(places.track.last.margin == (view >= 36 ? enough : 0));
  }
  places.track.views = 0;
  for (size_t view = 0; view < 40; ++view) {
    places.see(0, view, view, enough - 1);
    CHECK(places.track.last.margin == 0);
  }
}

TEST_CASE("a short track is confirmed with the margin, a long one at any margin") {
  Places places;
  for (size_t view = 0; view < 40; ++view) {
    places.see(0, view, view, view % 2 == 0 ? 8 * kUnit : 7 * kUnit);
    INFO(view);
    const bool is_confirmed = view >= 36 || (view >= 18 && view % 2 == 0);
    CHECK((places.track.last.margin > 0) == is_confirmed);
  }
}

TEST_CASE("a track is confirmed only if its last 24 keyframes support it") {
  Places places;
  places.z = -1.25;
  for (size_t view = 0; view < 20; ++view) places.see(0, view, view);
  CHECK(places.track.last.margin == 0);
  places.z = -2;
  // 24 keyframes, n with 2 and the others with 1.25, have a mean of 1.5 for n = 8.
  for (size_t view = 20; view < 28; ++view) {
    places.see(0, view, view);
    CHECK((places.track.last.margin > 0) == (view == 27));
  }
}

TEST_CASE("a track without support from recent frames is not confirmed, and is dropped") {
  Places places;
  for (size_t view = 0; view < 20; ++view) places.see(0, view, view, 32 * kUnit);
  REQUIRE(places.track.last.margin > 0);
  places.z = 0.25;  // support 0.875, with a mean of 1.89: a share of 0.46
  places.see(0, 20, 20, 21 * kUnit);
  CHECK(places.track.last.margin == 21 * kUnit);  // and 0.66 of the margin
  places.z = -0.9;                                // shares of 0.48 and 0.67
  places.see(0, 21, 21, 21 * kUnit);
  CHECK(places.track.last.margin == 21 * kUnit);
  places.change = 0.5;  // 0.375 less
  places.z = -1;
  places.see(0, 22, 22, 21 * kUnit);
  CHECK(places.track.last.margin == 0);
  CHECK(places.track.is_confirmed);
  CHECK(places.track.last.track == 1);  // not recognized, but the same track
  places.change = 0.125;  // a smaller change than in the training sequence has no effect
  places.z = -2;
  places.see(0, 23, 23, 8 * kUnit);  // shares of 0.81 and 0.27
  CHECK(places.track.last.margin == 0);
  places.see(0, 24, 24, 28 * kUnit);
  CHECK(places.track.last.margin == 28 * kUnit);
  places.z = 4;
  places.see(0, 25, 25);
  CHECK_FALSE(places.track.is_confirmed);
  CHECK(places.track.last.track == 0);
}

TEST_CASE("a track that is confirmed again, or at another place, has the next number") {
  Places places;
  for (size_t view = 0; view < 20; ++view) {
    places.see(0, view, view);
    CHECK(places.track.last.track == (view >= 18 ? 1 : 0));
  }
  for (size_t view = 20; view < 40; ++view) {
    places.see(1, view - 20, view);
    CHECK(places.track.last.track == (view >= 38 ? 2 : 0));
  }
}

TEST_CASE("confirmed tracks equal the reference implementation") {
  size_t confirmed = 0;
  size_t views = 0;
  for (uint64_t seed = 1; seed <= 40; ++seed) {
    Places places;
    RandomEngine engine(seed);
    std::vector<PlainView> seen;
    std::vector<uint8_t> found;
    size_t sequence = 0;
    size_t place = 0;
    const uint64_t margins = 8 + seed % 8;
    for (size_t view = 0; view < 120; ++view) {
      if (uniform_below(engine, 60) == 0) sequence = uniform_below(engine, 2);
      place = uniform_below(engine, 40) == 0
                  ? uniform_below(engine, 30)
                  : std::min<size_t>(place + uniform_below(engine, 2), 29);
      const auto margin = static_cast<uint32_t>(uniform_below(engine, margins * kUnit));
      places.z = 0.5 - static_cast<double>(uniform_below(engine, 5 * kUnit)) / kUnit;
      places.change = static_cast<double>(uniform_below(engine, 100)) / 128;
      places.see(sequence, place, view, margin);
      const size_t cell = places.cell(sequence, place);
      seen.push_back({cell, sequence, margin, places.supports, places.change - 0.25});
      found.push_back(places.track.last.margin > 0);
    }
    const std::vector<uint8_t> expected = plain_confirmed(seen, places.state.settings);
    for (size_t view = 0; view < seen.size(); ++view) {
      INFO("seed " << seed << ", view " << view);
      REQUIRE((found[view] != 0) == (expected[view] != 0 && seen[view].margin > 0));
      confirmed += found[view];
      ++views;
    }
  }
  CHECK(confirmed > views / 20);
  CHECK(confirmed < views / 2);
}

TEST_CASE("places near the best one, or of an overlapping sequence, are in the exclusion zone") {
  Places places;
  const auto margin_with = [&](size_t sequence, size_t place) {
    for (size_t view = 0; view < 20; ++view) places.see(0, view, view, 9 * kUnit);
    places.forget();
    places.state.values[places.cell(0, 20)] = kScoreBias + kUnit;
    places.state.values[places.cell(sequence, place)] = kScoreBias + 11 * kUnit;
    follow_keyframe(places.track, places.state, places.view(20, 24 * kUnit));
    return places.track.last.margin;
  };
  CHECK(margin_with(0, 10) == 24 * kUnit);
  CHECK(margin_with(0, 9) == 10 * kUnit);
  CHECK(margin_with(0, 30) == 24 * kUnit);
  CHECK(margin_with(0, 31) == 10 * kUnit);
  CHECK(margin_with(1, 3) == 10 * kUnit);
  places.track.shared = {{0, 1}, {1, 0}};
  CHECK(margin_with(1, 3) == 24 * kUnit);
}

TEST_CASE("within a keyframe, the position advances at the rate, up to its end") {
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
  places.see(1, 29, 60);  // the last keyframe of all
  CHECK(frame_at(60) == 138);
  CHECK(frame_at(90) == 139);
}
