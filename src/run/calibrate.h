// From a labeled walk to the threshold that other walks are queried with.
#pragma once

#include <string>
#include <vector>

#include "evaluate/calibration.h"
#include "run/query.h"
#include "run/sweep.h"

namespace vpr {

/// What a walk says of one window length.
struct CalibratedLength {
  SequenceQuerySettings
      settings;  ///< with the threshold, where there is one, as a query takes them
  Calibration calibration;
  size_t windows = 0;  ///< of the query
  size_t queries = 0;  ///< of which the place is trained
  size_t block = 1;    ///< windows in a row that are drawn together
};

/// The threshold of every window length, and the length to take.
struct CalibratedWalk {
  Sequence query;
  std::string protocol;                   ///< of the ground truth, in words
  std::vector<CalibratedLength> lengths;  ///< rising
  /// The shortest that recognizes correctly at least 0.7 of the windows that any does.
  std::optional<size_t> chosen;
};

/// `base`: the settings but c_l and the number that the decision asks for. `lengths`: c_l; of the
/// filter, which has windows of one frame, none. Throws Error(usage) for a precision
/// that is not above 0 and at most 1, decisions by threshold, methods that are not exact, and if
/// the ground truth shows no query window at a trained place; and what plan_query and run_query
/// throw.
CalibratedWalk calibrate_walk(const SequenceDatabase& database, const DescriptorSet& query,
                              const std::string& query_name, const ResolvedSettings& base,
                              std::vector<uint64_t> lengths, double precision,
                              const TruthReader& read_truth, const QueryResources& resources,
                              const Monitor& monitor);

}  // namespace vpr
