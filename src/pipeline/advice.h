// What to try where a threshold recognises nothing, or everything.
#pragma once

#include <optional>
#include <string>

#include "recognition/result.h"

namespace vpr {

/// A threshold, or margin, that would recognise the closest tenth of the query windows that have a
/// best match, at least one.
struct SuggestedThreshold {
  double threshold = 0;
  std::optional<ThresholdScale> scale = ThresholdScale::bits;  ///< none: it is a margin
  size_t windows = 0;                                          ///< that it recognises
};

/// What a t_r could be instead.
struct ThresholdAdvice {
  bool is_too_large = false;                    ///< else nothing is recognised
  std::string sentence;                         ///< what is wrong, and what the closest windows are
  std::optional<SuggestedThreshold> suggested;  ///< none if it would not be another one
};

/// Advice for a result without a hit, or one in which more than a fifth of all window pairs are
/// hits; nothing for others, and for one whose windows have no best match. The suggestion is on the
/// scale of the result, rounded to a number that people can read. Of a decision by margin: the
/// margin that a tenth of the query windows reach.
std::optional<ThresholdAdvice> threshold_advice(const Result& result);

/// The same of a result by margin, where nothing is recognised.
std::optional<ThresholdAdvice> margin_advice(const Result& result);

}  // namespace vpr
