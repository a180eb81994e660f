#include "evaluate/calibration.h"

#include <catch2/catch.hpp>

using namespace vpr;

namespace {

constexpr std::nullopt_t kNone = std::nullopt;

CalibrationSettings precision(double share) { return {share, 1, 1, 1}; }

}  // namespace

TEST_CASE("the strength is just above the incorrect windows, also of windows without their place") {
  // Correct at 9, 7 and 4, incorrect at 3; the second would reach 5 at another place.
  std::vector<CalibrationWindow> windows = {
      {9, kNone, 2}, {7, kNone, 5}, {kNone, 3, kNone}, {4, kNone, 1}};
  Calibration found = calibrate(windows, precision(1));
  CHECK(found.advice == CalibrationAdvice::calibrated);
  CHECK(found.strength == 6);
  CHECK(found.right == 2);
  CHECK(found.wrong == 0);
  windows[1].untrained = kNone;
  found = calibrate(windows, precision(1));
  CHECK(found.strength == 4);
  CHECK(found.right == 3);
}

TEST_CASE(
    "a window with a correct and an incorrect recognition counts as incorrect from there on") {
  const std::vector<CalibrationWindow> windows = {{9, 8, kNone}, {10, kNone, kNone}};
  const Calibration found = calibrate(windows, precision(1));
  CHECK(found.strength == 9);
  CHECK(found.right == 2);
  // At 8 and below, one of two is correct.
  CHECK(calibrate(windows, precision(0.5)).strength == 8);
  CHECK(calibrate(windows, precision(0.5)).wrong == 1);
  CHECK(calibrate(windows, precision(0.51)).strength == 9);
}

TEST_CASE("a lower precision uses the smallest sufficient strength, for any later errors") {
  // From strict to loose: correct, incorrect, incorrect, correct, correct: 1/1, 1/2, 1/3, 2/4, 3/5.
  const std::vector<CalibrationWindow> windows = {
      {9, kNone, 100}, {kNone, 8, kNone}, {kNone, 7, kNone}, {6, kNone, kNone}, {5, kNone, kNone}};
  CHECK(calibrate(windows, precision(0.6)).strength == 5);
  CHECK(calibrate(windows, precision(0.6)).right == 3);
  CHECK(calibrate(windows, precision(0.6)).wrong == 2);
  CHECK(calibrate(windows, precision(0.61)).strength == 9);
  CHECK(calibrate(windows, precision(0.3)).strength == 5);
  CHECK(calibrate(windows, {0.3, 8, 1, 1}).strength == 8);
}

TEST_CASE("missing requirements are reported") {
  const auto advice = [](std::vector<CalibrationWindow> windows, double share = 1,
                         int64_t least = 1) {
    const Calibration found = calibrate(windows, {share, least, 1, 1});
    CHECK(!found.strength);
    return found.advice;
  };
  CHECK(advice({}) == CalibrationAdvice::no_right_recognition);
  CHECK(advice({{4, kNone, 4}}) == CalibrationAdvice::none_is_safe);
  CHECK(advice({{4, 4, kNone}}, 0.9) == CalibrationAdvice::none_is_safe);
  CHECK(advice({{kNone, 4, kNone}}) == CalibrationAdvice::no_right_recognition);
  CHECK(advice({{4, kNone, kNone}}, 1, 5) == CalibrationAdvice::no_right_recognition);
  CHECK(advice({{kNone, 4, kNone}}, 0.9) == CalibrationAdvice::no_right_recognition);
}

TEST_CASE("without incorrect windows, the smallest strength is used") {
  const Calibration found =
      calibrate(std::vector<CalibrationWindow>{{4, kNone, kNone}}, {1, 3, 1, 1});
  CHECK(found.strength == 3);
  CHECK(found.expected.seen == 0);
  CHECK(found.expected.interval.low == 0);
  CHECK(found.expected.interval.high == Approx(2.9957));  // the rule of three
}

TEST_CASE("false recognitions equal those of thresholds from the other runs") {
  // Blocks of two: without the third and its neighbors the others reach 2, so that its windows,
  // incorrect at 8 and 7, are one false recognition. The last block is incorrect at 2, and passes
  // 8.
  std::vector<CalibrationWindow> windows(12, {20, kNone, 1});
  windows[4] = {kNone, 8, kNone};
  windows[5] = {kNone, 7, kNone};
  windows[10] = {kNone, 2, kNone};
  const CalibrationSettings settings = {1, 1, 2, 1};
  Calibration found = calibrate(windows, settings);
  CHECK(found.strength == 9);
  CHECK(found.expected.seen == 1);
  CHECK(found.expected.interval.low <= 0.0254);
  CHECK(found.expected.interval.high >= 5.57);  // of a Poisson count of one
  // Adjacent blocks include each other: neither is incorrect by the rest.
  windows[2] = {kNone, 9, kNone};
  found = calibrate(windows, settings);
  CHECK(found.strength == 10);
  CHECK(found.expected.seen == 2);
  windows[9] = {kNone, 9, kNone};
  found = calibrate(windows, settings);
  CHECK(found.expected.seen == 0);
}
