// What a ground truth says, as one short text that two reports can compare.
#pragma once

#include <string>

#include "base/monitor.h"

namespace vpr {

struct GroundTruth;
struct GroundTruthScope;

/// The checksum of the labels of all pairs, tolerance applied, and of the number of query frames.
/// It depends neither on the file's name nor on its format, and not on how the pairs came about:
/// two ground truths that say the same of every pair have the same. Training sequences count in
/// their order among those that were searched, whatever their names, and those without any pair at
/// the end do not count. Time linear in the runs of labels.
std::string ground_truth_fingerprint(const GroundTruth& truth, const GroundTruthScope& scope,
                                     const Monitor& monitor = {});

}  // namespace vpr
