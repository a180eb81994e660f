// Methods on the same queries: which is better, and by how much more than chance?
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/monitor.h"
#include "base/statistics.h"
#include "evaluate/metrics.h"

namespace vpr {

/// What is compared: the outcomes of one report.
struct NamedOutcomes {
  std::string name;
  Outcomes outcomes;
  /// False for another walk than the first method's (a replay of it, say), whose frames have no
  /// partners: it is measured over its own queries. The first method is paired.
  bool is_paired = true;
};

/// One metric of one method, against the first method.
struct ComparedValue {
  std::string key;                   ///< recall_at_1, average_precision, ...
  const Metric* metric = nullptr;    ///< its row of the table
  size_t method = 0;                 ///< index; 0 is the one that the others are compared with
  std::optional<double> value;       ///< over the common queries; of one not paired, over its own
  std::optional<double> difference;  ///< to the first method; none for itself, or where undefined
  std::optional<Interval> interval;  ///< 95 %, of the difference
};

/// Best matches of a method beside those of the first, over common queries with a match.
struct PairedCounts {
  uint64_t both_right = 0;
  uint64_t only_this = 0;
  uint64_t only_first = 0;
  uint64_t neither = 0;
};

/// Several methods on the same query frames, metric by metric.
struct Comparison {
  size_t common = 0;        ///< query frames that all paired methods judge
  size_t judged = 0;        ///< of these, with a match
  size_t disputed = 0;      ///< left out: ground truths do not agree on whether there is a match
  std::vector<size_t> own;  ///< per method, frames that it judges
  size_t block = 0;
  std::vector<ComparedValue> values;  ///< metric after metric, in each method after method
  std::vector<PairedCounts> paired;   ///< per method; nothing of one that is not paired
};

/// What to do where methods do not agree on which queries have a match.
enum class Disputed { refuse, leave_out };

/// Values and differences over the query frames that all paired methods judge (neither unreadable
/// nor ignored, and within reach of every method's windows): recall@K, which methods without ranks
/// know for K = 1 only (a K that none knows is left out), and every curve metric of best matches,
/// each method's by its own confidence (Outcomes::confidence).
/// Methods that are not paired have differences without intervals. Intervals are the central 95 %
/// of `resamples` differences under the circular block bootstrap (Politis and Romano 1992):
/// stretches of `block` neighboring queries are drawn with replacement, the same for all methods
/// (paired), and resamples without a value are left out. The same seed gives the same intervals.
/// Throws Error(data) for fewer than two methods, no common frame, or, unless these are left out,
/// methods that do not agree on which queries have a match.
Comparison compare_outcomes(std::span<const NamedOutcomes> methods, size_t block, size_t resamples,
                            uint64_t seed, const Monitor& monitor,
                            Disputed disputed = Disputed::refuse);

}  // namespace vpr
