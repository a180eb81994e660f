// From a walk of which the truth is known to a threshold for walks of which it is not.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "base/enum_names.h"
#include "base/statistics.h"

namespace vpr {

/// What a query window tells of every threshold there is. Strengths are margins,
/// summed over the window.
struct CalibrationWindow {
  std::optional<int64_t> right;  ///< it has a right recognition where no more than this is asked
  std::optional<int64_t> wrong;  ///< the same of a wrong recognition
  /// What the window would reach, were its place not trained: it is wrong for sure.
  std::optional<int64_t> untrained;
};

/// What a walk allows to say.
enum class CalibrationAdvice {
  calibrated,
  no_right_recognition,  ///< there is none at the least strength either
  none_is_safe           ///< where a right recognition is left, the precision is not reached
};
template <>
inline constexpr std::array<std::string_view, 3> kEnumNames<CalibrationAdvice> = {
    "calibrated", "no_right_recognition", "none_is_safe"};

struct CalibrationSettings {
  /// Of the recognized windows, the share that is right: above 0, at most 1.
  double precision = 1;
  int64_t least = 1;  ///< no smaller strength is chosen
  size_t block = 1;   ///< windows in a row that share frames: at least 1
  uint64_t seed = 1;  ///< of the bootstrap
};

/// False recognitions, each a run of windows in a row that are recognized wrongly, in a walk as
/// long as the one of calibration.
struct FalseRecognitions {
  uint64_t seen = 0;  ///< by thresholds that were chosen without the stretches in which they are
  Interval interval;  ///< 95 %
};

struct Calibration {
  CalibrationAdvice advice = CalibrationAdvice::no_right_recognition;
  std::optional<int64_t> strength;  ///< of the advice `calibrated`
  uint64_t right = 0;  ///< windows recognized at this strength, without a wrong recognition
  uint64_t wrong = 0;  ///< windows with a wrong recognition
  FalseRecognitions expected;
};

/// The least strength at which the precision is reached and some window is recognized rightly. A
/// window counts as wrong where it has a wrong recognition, whatever else it has. For precision 1
/// it is just above all that windows reach wrongly, or would if their place were not trained; for
/// less, only what they do reach counts. Windows must be in the order of the query; none are no
/// window.
Calibration calibrate(std::span<const CalibrationWindow> windows,
                      const CalibrationSettings& settings);

}  // namespace vpr
