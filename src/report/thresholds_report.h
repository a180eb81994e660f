// Automatic thresholds (vpr.thresholds/1): what they are, and from which windows they come.
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "pipeline/thresholds.h"
#include "report/run_info.h"
#include "report/table.h"

namespace vpr {

/// `thresholds`: one a window length, of the database's sequences.
Json thresholds_json(std::span<const TrainSequence> sequences,
                     const std::vector<AutomaticThresholds>& thresholds, double safety_factor,
                     const RunInfo& run);

/// One row a window length and sequence. `name`: of the database.
Table thresholds_table(std::span<const TrainSequence> sequences,
                       const std::vector<AutomaticThresholds>& thresholds, double safety_factor,
                       const std::string& name);

}  // namespace vpr
