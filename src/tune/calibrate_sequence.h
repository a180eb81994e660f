// Calibration of margins on a query sequence with ground truth.
#pragma once

#include <string>
#include <vector>

#include "tune/calibration.h"
#include "tune/sweep.h"

namespace vpr {

/// The calibration of one window length.
struct CalibratedLength {
  SequenceQuerySettings settings;  ///< with the calibrated margin, if there is one
  Calibration calibration;
  size_t windows = 0;  ///< of the query
  size_t queries = 0;  ///< windows at a trained place
  size_t block = 1;    ///< consecutive windows of a bootstrap block
};

/// The calibration of every window length, and the recommended length.
struct CalibratedSequence {
  Sequence query;
  std::string protocol;                   ///< of the ground truth, in words
  std::vector<CalibratedLength> lengths;  ///< increasing c_l
  /// The shortest with at least 0.7 of the correctly recognized windows of the best length; index.
  std::optional<size_t> chosen;
};

/// `base`: the settings except c_l and the margin. `lengths`: c_l; ignored for the filter, which
/// has windows of one frame. Throws Error(usage) for a precision that is not above 0 and at most 1,
/// and if the ground truth has no query window at a trained place; also throws what plan_query and
/// run_query throw.
CalibratedSequence calibrate_sequence(const SequenceDatabase& database, const DescriptorSet& query,
                                      const std::string& query_name, const ResolvedSettings& base,
                                      std::vector<uint64_t> lengths, double precision,
                                      const TruthReader& read_truth,
                                      const QueryResources& resources, const Monitor& monitor);

}  // namespace vpr
