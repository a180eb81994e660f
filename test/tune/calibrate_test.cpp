// Calibrated thresholds, and the counts of queries that use them.
#include <algorithm>

#include <catch2/catch.hpp>

#include "evaluate/outcomes.h"
#include "examples.h"
#include "queries.h"
#include "run/open.h"
#include "support.h"
#include "tune/calibration.h"

using namespace vpr;

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
    ensure_exclusion_zones(database, {});
  }
  GroundTruth truth() const {
    GroundTruth truth;
    truth.pairs.resize(100);
    for (uint32_t i = 0; i < 40; ++i) truth.pairs[20 + i] = {{0, 30 + i, PlaceLabel::same, 0}};
    truth.tolerance_frames = 2;
    return truth;
  }
  CalibratedSequence calibrate(const SequenceQuerySettings& settings, double precision = 1,
                               std::vector<uint64_t> lengths = {5, 10}) const {
    return calibrate_sequence(database, query, "q", settings, lengths, precision,
                              [&](const GroundTruthScope&) { return truth(); }, {}, {});
  }
  Result query_with(const SequenceQuerySettings& settings) const {
    return test::query_result(database, query, settings);
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
      const auto& chosen = walk.lengths[walk.chosen].calibration;
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
