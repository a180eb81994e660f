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
