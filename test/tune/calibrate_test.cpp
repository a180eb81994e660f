// Calibrated thresholds, and the counts of queries that use them.
#include <algorithm>

#include <catch2/catch.hpp>

#include "base/json.h"
#include "base/parallel.h"
#include "evaluate/outcomes.h"
#include "examples.h"
#include "queries.h"
#include "run/open.h"
#include "support.h"
#include "tune/calibrate_sequence.h"

using namespace vpr;
using test::resources;

namespace {

// Frames 20 to 59 of the query show training frames 30 to 69, with noise; the others show no place.
struct Walks {
  std::vector<LdbCode> train = test::walk_codes(120, 1, 150);
  SequenceDatabase database = test::make_database({train});
  DescriptorSet query;
  Walks() {
    std::vector<LdbCode> codes = test::walk_codes(100, 2, 150);
    for (size_t i = 0; i < 40; ++i)
      for (size_t word = 0; word < codes[0].size(); word += 2)
        codes[20 + i][word] = train[30 + i][word];
    query = test::make_query(codes);
    ensure_statistics(database, {});
    ensure_exclusion_zones(database, select_kernels(), {});
  }
  GroundTruth truth(size_t first = 20) const {
    GroundTruth truth;
    truth.pairs.resize(100);
    for (uint32_t i = 0; i < 40; ++i) truth.pairs[first + i] = {{0, 30 + i, PlaceLabel::same, 0}};
    truth.tolerance_frames = 2;
    return truth;
  }
  CalibratedSequence calibrate(const SequenceQuerySettings& settings, double precision = 1,
                               std::vector<uint64_t> lengths = {5, 10}) const {
    return calibrate_sequence(database, query, "q", settings, lengths, precision,
                              [&](const GroundTruthScope&) { return truth(); }, resources(), {});
  }
  Result query_with(const SequenceQuerySettings& settings) const {
    return run_query(plan_query(database, query, "q", settings, resources(), {}), settings,
                     resources(), {}, {})
        .result;
  }
};

std::vector<SequenceQuerySettings> decisions() {
  std::vector<SequenceQuerySettings> all;
  for (const Score score : {Score::raw, Score::zscore}) {
    all.emplace_back().score = score;
    all.back().decision = Decision::margin;
  }
  return all;
}

}  // namespace

TEST_CASE("a query with the calibrated settings has the recognitions of the calibration") {
  const Walks walks;
  const GroundTruth truth = walks.truth();
  for (const SequenceQuerySettings& settings : decisions())
    for (const double precision : {1.0, 0.8}) {
      const CalibratedSequence walk = walks.calibrate(settings, precision);
      REQUIRE(walk.chosen);
      for (const CalibratedLength& length : walk.lengths) {
        REQUIRE(length.calibration.strength);
        const Result result = walks.query_with(length.settings);
        const size_t recognized = recognized_windows(result);
        CHECK(recognized >= length.calibration.correct + length.calibration.incorrect);
        CHECK(length.calibration.correct > 0);
        CHECK(length.queries <= 40);
        if (precision == 1) CHECK(count_recognitions(result, truth).recognitions.incorrect == 0);
        if (precision == 1) CHECK(length.calibration.incorrect == 0);
      }
      const auto& chosen = walk.lengths[*walk.chosen].calibration;
      for (const CalibratedLength& length : walk.lengths)
        CHECK(0.7 * double(length.calibration.correct) <= double(chosen.correct));
    }
}

TEST_CASE(
    "the margin is just above the largest incorrect one, also of windows without their place") {
  const Walks walks;
  SequenceQuerySettings settings;
  settings.decision = Decision::margin;
  const CalibratedSequence walk = walks.calibrate(settings, 1, {5});
  const CalibratedLength& length = walk.lengths.front();
  SequenceQuerySettings open = length.settings;
  open.margin = 0;
  const Result result = walks.query_with(open);
  const GroundTruth truth = walks.truth();
  double largest = 0;
  for (size_t w = 0; w < result.best.size(); ++w)
    if (label_of(truth, *result.best[w], 5) == PlaceLabel::different && result.margins[w])
      largest = std::max(largest, *frame_margin(result, w));
  CHECK(*length.settings.margin > largest);
  CHECK(*length.settings.margin == double(*length.calibration.strength) / 5);
  open.margin = (double(*length.calibration.strength) - 1) / 5;
  CHECK(recognized_windows(walks.query_with(open)) >=
        recognized_windows(walks.query_with(length.settings)));
}

TEST_CASE("calibrations are the same for any number of threads") {
  const Walks walks;
  for (const SequenceQuerySettings& settings : decisions()) {
    std::vector<Json> found;
    for (const size_t threads : {1, 3}) {
      const ThreadLimit limit(threads);
      const CalibratedSequence walk = walks.calibrate(settings);
      found.push_back(settings_in_force(walk.lengths[*walk.chosen].settings));
      found.back()["seen"] = walk.lengths[*walk.chosen].calibration.expected.interval.high;
    }
    CHECK(found[0] == found[1]);
  }
}

TEST_CASE("a calibration without sufficient data is refused") {
  const Walks walks;
  SequenceQuerySettings settings = decisions().front();
  const auto calibrate = [&](const GroundTruth& truth, double precision) {
    return calibrate_sequence(walks.database, walks.query, "q", settings, {5}, precision,
                              [&](const GroundTruthScope&) { return truth; }, resources(), {});
  };
  GroundTruth nothing = walks.truth();
  for (auto& row : nothing.pairs) row.clear();
  CHECK_THROWS_WITH(calibrate(nothing, 1), Catch::Contains("no trained place"));
  for (const double precision : {0.0, 1.01, -1.0})
    CHECK_THROWS_WITH(calibrate(walks.truth(), precision), Catch::Contains("precision"));
  // With the ground truth of another sequence, correct matches are incorrect, and other ones are
  // closer.
  const CalibratedSequence walk = calibrate(walks.truth(60), 1);
  CHECK(!walk.chosen);
}
