// The filter over places and rates, compared with all paths, the reference implementation, and
// values computed by hand.
#include "match/filter.h"

#include <cmath>

#include <catch2/catch.hpp>

#include "base/parallel.h"
#include "base/random.h"
#include "base/simd.h"
#include "examples.h"
#include "match/score_kernels.h"
#include "reference/plain_filter.h"
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

FilterState start(const test::Example& example, const FilterSettings& settings = {}) {
  const std::vector<DescribedFrames> spans = example.spans();
  return start_filter(frame_distances(spans, {spans[0].rows.first(0), {}}), settings, 1);
}

// Scores in the middle of the ranges with equal likelihood.
std::vector<uint16_t> random_scores(size_t count, RandomEngine& engine) {
  std::vector<uint16_t> scores(count);
  for (uint16_t& score : scores)
    score = static_cast<uint16_t>(kScoreBias - 6 * kScoreUnit +
                                  kScoresPerLikelihood * uniform_below(engine, 10 * 64) +
                                  kScoresPerLikelihood / 2);
  return scores;
}

double deviations(uint32_t value) { return (static_cast<double>(value) - kScoreBias) / kScoreUnit; }

/// A state of a path: off the map, or at a place with a rate.
struct Stay {
  bool off_map = true;
  size_t place = 0;
  size_t rate = 0;
};

double chance_of_step(const Stay& from, const Stay& to, size_t places,
                      const FilterSettings& settings) {
  const auto& rates = filter_rates();
  const double anywhere = rates[to.rate].prior / static_cast<double>(places);
  if (from.off_map) return to.off_map ? 1 - settings.leave : settings.leave * anywhere;
  if (to.off_map) return settings.enter;
  const double turns = settings.rate_change * rates[to.rate].prior +
                       (from.rate == to.rate ? 1 - settings.rate_change : 0);
  double steps = 0;
  for (size_t s = 0; s < kSteps; ++s)
    if (from.place + kFirstSteps[to.rate] + s == to.place) steps += rates[to.rate].steps[s];
  return (1 - settings.enter) * (settings.jump * anywhere + (1 - settings.jump) * turns * steps);
}

/// All paths through the keyframes so far: the mass of each last state.
struct AllPaths {
  size_t places = 0;
  FilterSettings settings;
  std::vector<std::vector<uint16_t>> scores;  ///< by keyframe
  std::vector<double> masses;                 ///< by place, and off the map

  double likelihood(const Stay& stay, size_t view) const {
    if (stay.off_map) return 1;
    const double z = (static_cast<double>(scores[view][stay.place]) - kScoreBias) / kScoreUnit;
    return std::exp(-settings.sharpness * (std::min(z, 8.0) - settings.unmatched));
  }

  std::vector<Stay> stays() const {
    std::vector<Stay> all = {{}};
    for (size_t place = 0; place < places; ++place)
      for (size_t rate = 0; rate < kRates; ++rate) all.push_back({false, place, rate});
    return all;
  }

  void follow(const Stay& from, double mass, size_t view) {
    if (view == scores.size()) {
      masses[from.off_map ? places : from.place] += mass;
      return;
    }
    for (const Stay& to : stays())
      follow(to, mass * chance_of_step(from, to, places, settings) * likelihood(to, view),
             view + 1);
  }

  void run() {
    masses.assign(places + 1, 0);
    for (const Stay& from : stays())
      follow(
          from,
          0.5 * (from.off_map ? 1 : filter_rates()[from.rate].prior / static_cast<double>(places)),
          0);
  }
};

}  // namespace

TEST_CASE("the filter sums over all paths") {
  RandomEngine engine(3);
  for (const auto& [places, views] :
       {std::pair<size_t, size_t>{1, 4}, {2, 4}, {3, 3}, {5, 2}, {8, 1}}) {
    AllPaths paths{places, {}, {}, {}};
    paths.settings.jump = 0.05;
    FilterState state = start(unrelated({places}), paths.settings);
    REQUIRE(state.cells.places == places);
    for (size_t view = 0; view < views; ++view) {
      paths.scores.push_back(random_scores(places, engine));
      advance_filter(state, paths.scores.back());
    }
    paths.run();
    double total = 0;
    for (const double mass : paths.masses) total += mass;
    INFO(places << " places, " << views << " views");
    constexpr double kClose = 0.004;  // twice 1/1024, and the rounding of mantissas
    for (size_t place = 0; place < places; ++place)
      CHECK(
          deviations(state.values[kLongestStep + place]) ==
          Approx(-std::log(paths.masses[place] / total) / paths.settings.sharpness).margin(kClose));
    CHECK(
        deviations(state.nowhere_value) ==
        Approx(-std::log(paths.masses[places] / total) / paths.settings.sharpness).margin(kClose));
  }
}

TEST_CASE("the filter equals the reference implementation, and no step crosses a run") {
  test::Example example = unrelated({40, 1, 2, 300, 3});
  example.train_unreadable[3] = {0, 17, 18, 299};
  RandomEngine engine(5);
  FilterState state = start(example);
  PlainFilter plain = start_plain_filter(state.cells, {});
  const size_t frames = 40 + 1 + 2 + 300 + 3;
  CHECK(state.cells.places == frames - 4);
  for (size_t view = 0; view < 60; ++view) {
    const std::vector<uint16_t> scores = random_scores(frames, engine);
    advance_filter(state, scores);
    advance_plain_filter(plain, scores);
    for (size_t cell = 0; cell < state.cells.size(); ++cell) {
      if (plain.masses[cell] == 0) {
        REQUIRE(state.values[cell] == kNoValue);
        continue;
      }
      REQUIRE(deviations(state.values[cell]) == Approx(plain_value(plain, cell)).margin(0.006));
    }
    REQUIRE(deviations(state.nowhere_value) == Approx(plain_nowhere_value(plain)).margin(0.006));
  }
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
        seen.push_back(state.nowhere_value);
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
  const auto refused = [](double FilterSettings::*key, double value) {
    FilterSettings settings;
    settings.*key = value;
    return test::error_kind([&] { check_filter(settings); });
  };
  CHECK_FALSE(test::error_kind([] { check_filter({}); }));
  CHECK(refused(&FilterSettings::sharpness, 0) == ErrorKind::usage);
  CHECK(refused(&FilterSettings::jump, 0) == ErrorKind::usage);
  CHECK(refused(&FilterSettings::enter, 0.6) == ErrorKind::usage);
  CHECK(refused(&FilterSettings::leave, std::nan("")) == ErrorKind::usage);
  CHECK(refused(&FilterSettings::keyframe_change, -1) == ErrorKind::usage);
  CHECK(refused(&FilterSettings::confirm_margin, -1) == ErrorKind::usage);
  CHECK(refused(&FilterSettings::confirm_evidence, -1) == ErrorKind::usage);
  CHECK(refused(&FilterSettings::present_support, 3) == ErrorKind::usage);
}
