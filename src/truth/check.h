// Summary, damage check and fingerprint of a ground truth.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "base/monitor.h"
#include "truth/ground_truth.h"

namespace vpr {

/// Counts over all sequences, tolerance applied.
struct GroundTruthSummary {
  uint64_t query_frames = 0;
  uint64_t train_frames = 0;
  uint64_t same = 0;                      ///< pairs of the same place
  uint64_t ignored = 0;                   ///< pairs to ignore
  uint64_t queries_without_match = 0;     ///< no pair of the same place
  uint64_t references_without_match = 0;  ///< of training frames
  uint64_t most_matches = 0;              ///< of any query
  /// Pairs (i, j) of the same place for which (j, i) is not: in a ground truth of a sequence
  /// against itself a mistake, between two walks usual. Nothing unless there is one sequence with
  /// as many frames as the query, and at most 2^26 pairs.
  std::optional<uint64_t> one_sided;
  std::vector<std::string> one_sided_examples;
};

/// Counts the pairs of a ground truth; its time grows with runs of frames, not with pairs.
GroundTruthSummary summarise(const InspectedGroundTruth& ground_truth, const Monitor& monitor = {});

/// Checks that a ground truth can be trusted. Throws Error(data), with the first of them, if a pair
/// is out of range or contradicts another.
void require_undamaged(const InspectedGroundTruth& ground_truth, const std::string& name);

/// The checksum of the labels of all pairs, tolerance applied, and of the number of query frames.
/// It depends neither on the file's name nor on its format, and not on how the pairs came about:
/// two ground truths that say the same of every pair have the same. Training sequences count in
/// their order among those that were searched, whatever their names, and those without any pair at
/// the end do not count. Time linear in the runs of labels.
std::string ground_truth_fingerprint(const GroundTruth& truth, const GroundTruthScope& scope,
                                     const Monitor& monitor = {});

}  // namespace vpr
