// The precision-recall curve, exact: every threshold that changes it, ties together.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "recognition/score_order.h"

namespace vpr {

/// One threshold: what scores exactly this much enters together.
struct CurvePoint {
  uint64_t key = 0;               ///< the threshold as score_key; accepted are keys up to it
  uint64_t correct = 0;           ///< correct ones accepted
  uint64_t incorrect_before = 0;  ///< incorrect ones that score better than the threshold
  uint64_t incorrect = 0;         ///< incorrect ones accepted

  bool operator==(const CurvePoint&) const = default;
};

/// Points from the strictest threshold on: the best score, every score that something correct has,
/// and the worst score. Between two points only incorrect ones enter, so nothing is lost.
struct Curve {
  ScoreOrder kind = ScoreOrder::distance;
  uint64_t to_find = 0;  ///< the denominator of recall: at least the correct ones that have a score
  std::vector<CurvePoint> points;

  double threshold(const CurvePoint& point) const { return score_of_key(point.key, kind); }
  double recall(const CurvePoint& point) const {
    return to_find == 0 ? 0 : static_cast<double>(point.correct) / static_cast<double>(to_find);
  }
  /// Every point has accepted something.
  static double precision(const CurvePoint& point) {
    return static_cast<double>(point.correct) /
           static_cast<double>(point.correct + point.incorrect);
  }
  bool operator==(const Curve&) const = default;
};

/// Something that was scored: a pair, or a query's best match.
struct ScoredItem {
  uint64_t key = 0;
  bool is_correct = false;
  uint32_t weight = 1;  ///< how often it counts; 0: not at all
};

/// Sorts best first; items of one key in any order.
void sort_items(std::vector<ScoredItem>& items);

/// `items` are sorted; those without a score (kNoScore) are left out. No items give no points.
Curve curve_of(std::span<const ScoredItem> items, uint64_t to_find, ScoreOrder kind);

}  // namespace vpr
