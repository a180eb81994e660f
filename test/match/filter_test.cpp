// The filter over places and rates, compared with all paths, the reference implementation, and
// values computed by hand.
#include "match/filter.h"

#include <algorithm>
#include <cmath>

#include <catch2/catch.hpp>

#include "base/parallel.h"
#include "base/random.h"
#include "base/simd.h"
#include "examples.h"
#include "match/score_kernels.h"
#include "reference/reference_filter.h"
#include "support.h"

using namespace vpr;

namespace {

// Sequences of unrelated frames: every frame is a keyframe.
test::Example unrelated(const std::vector<size_t>& frames) {
  test::Example example;
  for (size_t s = 0; s < frames.size(); ++s)
    example.train.push_back(test::random_codes(frames[s], 10 + s));
  example.train_unreadable.resize(frames.size());
  return example;
}

FilterState start(const test::Example& example) {
  const std::vector<DescribedFrames> spans = example.spans();
  return start_filter(frame_distances(spans, {spans[0].rows.first(0), {}}), {}, 1);
}

// Scores in the middle of the ranges with equal likelihood.
std::vector<uint16_t> random_scores(size_t count, RandomEngine& engine) {
  std::vector<uint16_t> scores(count);
  for (uint16_t& score : scores)
    score = static_cast<uint16_t>(kScoreBias - 4 * kScoreUnit +
                                  kScoresPerLikelihood * uniform_below(engine, 8 * 64) +
                                  kScoresPerLikelihood / 2);
  return scores;
}

double deviations(uint32_t value) { return (static_cast<double>(value) - kScoreBias) / kScoreUnit; }

/// A place on a path, and its rate.
struct Stay {
  size_t place = 0;
  size_t rate = 0;
};

double chance_of_step(const Stay& from, const Stay& to) {
  const auto& rates = filter_rates();
  double steps = 0;
  for (size_t s = 0; s < kSteps; ++s)
    if (from.place + kFirstSteps[to.rate] + s == to.place) steps += rates[to.rate].steps[s];
  return steps *
         (kRateChange * rates[to.rate].prior + (from.rate == to.rate ? 1 - kRateChange : 0));
}

/// All paths through the keyframes so far, from any keyframe on: the mass of each last place.
struct AllPaths {
  size_t places = 0;
  std::vector<std::vector<uint16_t>> scores;  ///< by keyframe
  std::vector<double> masses;                 ///< by place

  double likelihood(const Stay& stay, size_t view) const {
    return std::exp(kSharpness *
                    (kUnrelated - std::min(deviations(scores[view][stay.place]), 8.0)));
  }

  std::vector<Stay> stays() const {
    std::vector<Stay> all;
    for (size_t place = 0; place < places; ++place)
      for (size_t rate = 0; rate < kRateCount; ++rate) all.push_back({place, rate});
    return all;
  }

  // `mass`: of the path up to keyframe `view`.
  void follow(const Stay& from, double mass, size_t view) {
    if (view + 1 == scores.size()) {
      masses[from.place] += mass;
      return;
    }
    for (const Stay& to : stays())
      if (const double chance = chance_of_step(from, to); chance > 0)
        follow(to, mass * chance * likelihood(to, view + 1), view + 1);
  }

  void run() {
    masses.assign(places, 0);
    for (size_t view = 0; view < scores.size(); ++view)
      for (const Stay& start : stays())
        follow(start, filter_rates()[start.rate].prior * likelihood(start, view), view);
  }
};

}  // namespace

TEST_CASE("the filter sums over all paths") {
  RandomEngine engine(3);
  for (const auto& [places, views] :
       {std::pair<size_t, size_t>{1, 4}, {2, 4}, {3, 3}, {5, 2}, {8, 1}}) {
    AllPaths paths{places, {}, {}};
    FilterState state = start(unrelated({places}));
    REQUIRE(state.cells.places == places);
    for (size_t view = 0; view < views; ++view) {
      paths.scores.push_back(random_scores(places, engine));
      advance_filter(state, paths.scores.back());
    }
    paths.run();
    INFO(places << " places, " << views << " views");
    REQUIRE(state.kept == 1);
    for (size_t place = 0; place < places; ++place)
      CHECK(deviations(state.values[kLongestStep + place]) ==
            Approx(-std::log(paths.masses[place]) / kSharpness).margin(0.006));
  }
}

TEST_CASE("the filter equals the reference implementation, and no step crosses a run") {
  test::Example example = unrelated({40, 1, 2, 300, 3});
  example.train_unreadable[3] = {0, 17, 18, 299};
  RandomEngine engine(5);
  FilterState state = start(example);
  ReferenceFilter plain = start_reference_filter(state.cells);
  const size_t frames = 40 + 1 + 2 + 300 + 3;
  CHECK(state.cells.places == frames - 4);
  double least_kept = 1;
  for (size_t view = 0; view < 60; ++view) {
    std::vector<uint16_t> scores = random_scores(frames, engine);
    scores[view % 40] = kScoreBias - 4 * kScoreUnit + kScoresPerLikelihood / 2;  // a path
    advance_filter(state, scores);
    advance_reference_filter(plain, scores);
    least_kept = std::min(least_kept, state.kept);
    for (size_t cell = 0; cell < state.cells.size(); ++cell) {
      if (plain.masses[cell] == 0) {
        REQUIRE(state.values[cell] == kNoValue);
        continue;
      }
      REQUIRE(deviations(state.values[cell]) == Approx(reference_value(plain, cell)).margin(0.01));
    }
  }
  CHECK(least_kept < 1);
}

TEST_CASE("the evidence of a path is bounded, and a new path has none") {
  FilterState state = start(unrelated({300}));
  std::vector<uint16_t> scores(300, kScoreBias + kScoreUnit);
  for (size_t view = 0; view < 100; ++view) {
    scores.assign(300, kScoreBias + kScoreUnit);
    scores[view + 100] = kScoreBias - 3 * kScoreUnit;
    advance_filter(state, scores);
  }
  const double least = deviations(*std::ranges::min_element(state.values));
  CHECK(least == Approx(-kMostEvidence / kSharpness).margin(0.01));
  CHECK(deviations(kNewPathValue) == 0);
  CHECK(deviations(state.values[kLongestStep + 20]) > 0);
}

TEST_CASE("every SIMD target and any number of threads give the same values") {
  const test::Example example = unrelated({70'001, 9});  // more than two chunks
  std::vector<std::vector<uint32_t>> values;
  for (const std::string& target : simd_targets()) {
    const test::ChosenTarget chosen(target);
    for (const size_t threads : {1, 3}) {
      const ThreadLimit limit(threads);
      RandomEngine engine(8);
      FilterState state = start(example);
      std::vector<uint32_t> seen;
      for (size_t view = 0; view < 5; ++view) {
        advance_filter(state, random_scores(70'010, engine));
        seen.insert(seen.end(), state.values.begin(), state.values.end());
      }
      values.push_back(std::move(seen));
      REQUIRE(values.back() == values.front());
    }
  }
}

TEST_CASE("a restarted filter has forgotten all keyframes") {
  RandomEngine engine(2);
  FilterState state = start(unrelated({30}));
  const std::vector<uint16_t> first = random_scores(30, engine);
  advance_filter(state, first);
  const std::vector<uint32_t> values = state.values;
  advance_filter(state, random_scores(30, engine));
  CHECK(state.values != values);
  restart_filter(state);
  advance_filter(state, first);
  CHECK(state.values == values);
}

TEST_CASE("keyframes are farther apart, and more of them near, at high frame rates") {
  test::Example example;
  LdbCode code = {};
  for (size_t frame = 0; frame < 60; ++frame) {  // frames k apart differ by 10 k bits
    example.train.resize(1);
    example.train[0].push_back(code);
    for (size_t bit = 10 * frame; bit < 10 * frame + 10; ++bit)
      code[bit / 8] = static_cast<uint8_t>(code[bit / 8] | (1U << bit % 8));
  }
  example.train_unreadable.resize(1);
  const std::vector<DescribedFrames> spans = example.spans();
  const FrameDistances distances = frame_distances(spans, {spans[0].rows.first(0), {}});
  const FilterSettings settings;
  const auto adapted = [&](double typical) {
    return adapted_settings(distances, settings, typical);
  };
  CHECK(adapted(20).keyframe_change == settings.keyframe_change);  // change per frame: 0.5
  CHECK(adapted(20).near_keyframes == 10);
  CHECK(adapted(30).keyframe_change == Approx(0.15 * (1 + 1.0 / 27)));  // 0.33
  CHECK(adapted(30).near_keyframes == 12);            // of 10 bits each: 4 typical distances
  CHECK(adapted(90).keyframe_change == Approx(0.2));  // 0.11: every second frame is a keyframe
  CHECK(adapted(90).near_keyframes == 15);            // instead of 18
  CHECK(adapted(90).path_keyframes == settings.path_keyframes);
  example.train[0].assign(60, code);  // a standing camera
  const std::vector<DescribedFrames> still = example.spans();
  const FrameDistances none = frame_distances(still, {still[0].rows.first(0), {}});
  CHECK(adapted_settings(none, settings, 100).keyframe_change == settings.keyframe_change);
}

TEST_CASE("filter settings out of range are refused") {
  const auto refused = [](auto FilterSettings::*key, auto value) {
    FilterSettings settings;
    settings.*key = value;
    return test::error_kind([&] { check_filter(settings); });
  };
  CHECK_FALSE(test::error_kind([] { check_filter({}); }));
  CHECK(refused(&FilterSettings::keyframe_change, -1.0) == ErrorKind::usage);
  CHECK(refused(&FilterSettings::near_keyframes, uint64_t{1} << 40) == ErrorKind::usage);
  CHECK(refused(&FilterSettings::path_keyframes, uint64_t{1} << 40) == ErrorKind::usage);
}
