// Comparison of several methods on the same queries, with confidence intervals.
#pragma once

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
  /// is then measured over its own queries. The first method is paired.
  bool is_paired = true;
};

/// One metric of one method, compared with the first method.
struct ComparedValue {
  MetricAt metric;
  size_t method = 0;
  std::optional<double> value;       ///< over the common queries; unpaired: over its own queries
  std::optional<double> difference;  ///< from the first method
  std::optional<Interval> interval;  ///< 95 %, of the difference
};

/// Best matches of a method and of the first method, over common queries with a match.
struct PairedCounts {
  uint64_t both_correct = 0;
  uint64_t only_this = 0;
  uint64_t only_first = 0;
  uint64_t neither = 0;
};

struct Comparison {
  size_t common = 0;        ///< query frames that all paired methods judge
  size_t judged = 0;        ///< of these, with a match
  size_t disputed = 0;      ///< omitted: the ground truths disagree on whether there is a match
  std::vector<size_t> own;  ///< judged frames per method
  size_t block = 0;
  std::vector<ComparedValue> values;  ///< by metric, then method
  std::vector<PairedCounts> paired;   ///< per method; zeros for an unpaired one
};

/// The reaction to methods that disagree on which queries have a match.
enum class Disputed { refuse, omit_disputed };

/// Values and differences over the query frames that all paired methods judge (neither unreadable
/// nor ignored, and reachable by the windows of every method): metrics of the first correct rank,
/// for K > 1 only if any method has ranks, and every curve metric of best matches, by the
/// confidence of each method (Outcomes::confidence). Intervals are the central 95 % of the
/// differences of `resamples` circular block bootstraps (Politis and Romano 1992): blocks of
/// `block` consecutive queries are drawn with replacement, the same for all paired methods;
/// resamples without a value are skipped. The same seed yields the same intervals. Throws
/// Error(data) for fewer than two methods, no common frame, or disputed queries that are refused.
Comparison compare_outcomes(std::span<const NamedOutcomes> methods, size_t block, size_t resamples,
                            uint64_t seed, const Monitor& monitor,
                            Disputed disputed = Disputed::refuse);

}  // namespace vpr
