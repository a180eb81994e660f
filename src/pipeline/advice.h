// What to try where a threshold recognises nothing, or everything.
#pragma once

#include <optional>
#include <string>

#include "recognition/result.h"

namespace vpr {

/// A threshold that would recognise the closest tenth of the query windows that have a best match,
/// at least one.
struct SuggestedThreshold {
  double threshold = 0;
  ThresholdScale scale = ThresholdScale::bits;
  size_t windows = 0;  ///< that it recognises
};

struct ThresholdAdvice {
  bool is_too_large = false;                    ///< else nothing is recognised
  std::string sentence;                         ///< what is wrong, and what the closest windows are
  std::optional<SuggestedThreshold> suggested;  ///< none if it would not be another one
};

/// For a result without a hit, or one in which more than a fifth of all window pairs are hits;
/// nothing for others, and for one whose windows have no best match. The suggestion is on the scale
/// of the result, rounded up to a number that people can read.
std::optional<ThresholdAdvice> threshold_advice(const Result& result);

}  // namespace vpr
