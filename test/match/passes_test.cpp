// Repeated places of training sequences, and queries of such sequences.
#include <algorithm>

#include <catch2/catch.hpp>

#include "base/parallel.h"
#include "base/random.h"
#include "base/simd.h"
#include "examples.h"
#include "match/components.h"
#include "match/distance_statistics.h"
#include "match/filter_track.h"
#include "match/match.h"
#include "match/score_kernels.h"
#include "match/zscores.h"
#include "support.h"

using namespace vpr;

namespace {

constexpr uint32_t kLeast = 14 * kScoreUnit;

// Appends the codes, each with 30 changed bits.
void append_noisy(std::vector<LdbCode>& codes, const std::vector<LdbCode>& more, uint64_t seed) {
  RandomEngine engine(seed);
  for (LdbCode code : more) {
    for (int i = 0; i < 30; ++i) {
      const uint64_t bit = uniform_below(engine, kLdbBits);
      code[bit / 8] = static_cast<uint8_t>(code[bit / 8] ^ 1 << bit % 8);
    }
    codes.push_back(code);
  }
}

TrainStatistics statistics_of(const std::vector<DescribedFrames>& spans) {
  TrainStatistics statistics = compute_statistics(spans, {}, {});
  statistics.components = compute_components(spans, statistics.typical_distance, {});
  return statistics;
}

std::vector<RepeatedPlace> passes_of(const test::Example& example,
                                     size_t exhaustive_places = kExhaustivePlaces) {
  const std::vector<DescribedFrames> spans = example.spans();
  return find_passes(spans, statistics_of(spans), kLeast, {}, exhaustive_places);
}

// Query frames at which the path has the margin.
size_t frames_with_margin(const test::Example& example, const std::vector<RepeatedPlace>& passes) {
  const std::vector<DescribedFrames> spans = example.spans();
  MatchSettings settings{1, size_t{1} << 30};
  settings.method = &find_sequence_method("filter");
  settings.passes = passes;
  size_t frames = 0;
  const ScoreBasis basis = make_score_basis(statistics_of(spans));
  match(zscores(frame_distances(spans, {example.query, {}}), basis), settings,
        {{}, {[&](std::span<const ScoreRow> row) {
           frames += row.front().path->margin >= kLeast ? 1 : 0;
         }}},
        {});
  return frames;
}

}  // namespace

TEST_CASE("later passes are linked to the first one, in every sequence") {
  const std::vector<LdbCode> lap = test::walk_codes(120, 1);
  test::Example example;
  example.train = {lap, test::walk_codes(80, 9)};
  example.train_unreadable = {{200}, {}};
  append_noisy(example.train[0], lap, 2);
  append_noisy(example.train[0], lap, 3);
  append_noisy(example.train[1], lap, 4);
  const std::vector<RepeatedPlace> passes = passes_of(example);
  CHECK(passes.size() > 300);
  for (const RepeatedPlace& repeated : passes) {
    INFO(repeated.frame);
    REQUIRE(repeated.frame >= 120);
    REQUIRE((repeated.frame < 360 || repeated.frame >= 440));
    const size_t truth = (repeated.frame - (repeated.frame < 360 ? 0 : 440)) % 120;
    CHECK(std::max<size_t>(truth, repeated.first_pass) <=
          std::min<size_t>(truth, repeated.first_pass) + 10);
  }
  CHECK(std::ranges::is_sorted(passes, {}, &RepeatedPlace::frame));

  append_noisy(example.query, lap, 5);
  CHECK(frames_with_margin(example, {}) == 0);
  CHECK(frames_with_margin(example, passes) >= 90);
}

TEST_CASE("a walk without repetition, or of too few keyframes, repeats no place") {
  test::Example example;
  example.train = {test::walk_codes(300, 1), test::walk_codes(1, 2), test::walk_codes(40, 3)};
  example.train_unreadable.resize(3);
  CHECK(passes_of(example).empty());
}

TEST_CASE("passes of many keyframes are found by a coarse search first") {
  const std::vector<LdbCode> lap = test::walk_codes(400, 1);
  test::Example example;
  example.train = {lap, test::walk_codes(300, 9)};
  example.train_unreadable.resize(2);
  append_noisy(example.train[0], test::walk_codes(500, 5), 2);
  append_noisy(example.train[0], lap, 3);
  const std::vector<RepeatedPlace> passes = passes_of(example, 0);
  CHECK(passes.size() + 10 > passes_of(example).size());
  const auto is_correct = [](const RepeatedPlace& repeated) {
    return repeated.frame >= 900 && repeated.frame < 1300 &&
           std::max(repeated.frame - 900, repeated.first_pass) <=
               std::min(repeated.frame - 900, repeated.first_pass) + 10;
  };
  CHECK(std::ranges::count_if(passes, is_correct) > 180);
  CHECK(std::ranges::count_if(passes, is_correct) + 20 >
        static_cast<std::ptrdiff_t>(passes.size()));
  const ThreadLimit one(1);
  for (const std::string& target : simd_targets()) {
    const test::ChosenTarget chosen(target);
    INFO(target);
    CHECK(passes_of(example, 0) == passes);
  }
}

TEST_CASE("a coarse search finds no pass in a walk without repetition") {
  test::Example example;
  example.train = {test::walk_codes(900, 1)};
  example.train_unreadable.resize(1);
  CHECK(passes_of(example, 0).empty());
}
