#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/monitor.h"
#include "truth/ground_truth.h"

namespace vpr {

/// Counts over all sequences, with the tolerance applied.
struct GroundTruthSummary {
  uint64_t query_frames = 0;
  uint64_t train_frames = 0;
  uint64_t same = 0;                      ///< pairs of the same place
  uint64_t ignored = 0;                   ///< pairs to ignore
  uint64_t queries_without_match = 0;     ///< query frames without a pair of the same place
  uint64_t references_without_match = 0;  ///< training frames without a pair of the same place
  uint64_t most_matches = 0;              ///< maximum over all query frames
  /// Pairs (i, j) of the same place for which (j, i) is not: an error in a ground truth of a
  /// sequence with itself, normal for two sequences. Set only for one training sequence with as
  /// many frames as the query, and at most 2^26 pairs.
  std::optional<uint64_t> one_sided;
  std::vector<std::string> one_sided_examples;
};

/// Counts the pairs of a ground truth, in time linear in the runs of frames, not in pairs.
GroundTruthSummary summarize(const InspectedGroundTruth& ground_truth, const Monitor& monitor = {});

/// Throws Error(data), with the first such pair, if a pair is out of range or contradicts another.
void require_undamaged(const InspectedGroundTruth& ground_truth, const std::string& name);

/// The checksum of the labels of all pairs, with the tolerance applied, and of the number of query
/// frames. It does not depend on the file's name, its format or the origin of the pairs: ground
/// truths with equal labels have equal fingerprints. Training sequences count in their order among
/// the searched ones, without their names; those at the end without any pair do not count. Time
/// linear in the runs of labels.
std::string ground_truth_fingerprint(const GroundTruth& truth, const GroundTruthScope& scope,
                                     const Monitor& monitor = {});

}  // namespace vpr
