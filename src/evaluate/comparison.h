// Comparison of several methods on the same queries, with confidence intervals.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "base/statistics.h"
#include "evaluate/metrics.h"

namespace vpr {

/// A method: the outcomes of one report.
struct NamedOutcomes {
  std::string name;
  Outcomes outcomes;
  /// False if its query frames differ from those of the first method, as with another selection: it
  /// is then measured over its own frames. The first method is paired.
  bool is_paired = true;
};

/// One metric of one method, compared with the first method.
struct ComparedValue {
  MetricAt metric;
  size_t method = 0;
  std::optional<double> value;       ///< over the compared frames; unpaired: over its own
  std::optional<double> difference;  ///< from the first method
  std::optional<Interval> interval;  ///< 95 %, of the difference
  std::optional<Interval> own;       ///< 95 %, of the value
  bool is_best = false;  ///< better than every other paired method: no interval contains 0
};

/// The low and the high end; unset without an interval.
inline std::array<std::optional<double>, 2> ends_of(const std::optional<Interval>& interval) {
  if (!interval) return {};
  return {interval->low, interval->high};
}

struct Comparison {
  std::vector<size_t> frames;  ///< query frames of paired methods that are compared
  size_t with_match = 0;       ///< of these
  size_t disputed = 0;         ///< omitted: the ground truths disagree on whether there is a match
  size_t block = 0;
  std::vector<ComparedValue> values;  ///< by metric, then method
};

struct ComparisonSettings {
  size_t block = 0;  ///< consecutive frames that are drawn together; 0: by block_length
  size_t resamples = 2000;
  uint64_t seed = 0;
  /// Only frames for which every paired method has a best match that is not ignored.
  bool only_common = false;
  /// Omits frames on whose match the ground truths disagree, which otherwise are an error.
  bool omit_disputed = false;
  std::vector<size_t> recall_at = {};  ///< K of recall@K, with 1; empty: kRecallAt
};

/// Values and differences over the query frames of all paired methods: metrics of the first correct
/// rank, for K > 1 only if any method has ranks, and every curve metric of best matches, by the
/// confidence of each method (Outcomes::confidence). Intervals are the central 95 % of the values,
/// and of the differences, of circular block bootstraps (Politis and Romano 1992): blocks of
/// consecutive frames are drawn with replacement, the same for all paired methods; resamples
/// without a value are skipped. The default block is the largest block_length of any paired
/// method's series of correct best matches over the frames with a match, in frames of the query.
/// The same seed yields the same intervals. Throws Error(data) without methods, for different
/// numbers of frames, no frame to compare, or disputed frames.
Comparison compare_outcomes(std::span<const NamedOutcomes> methods,
                            const ComparisonSettings& settings, const Monitor& monitor);

}  // namespace vpr
