// What a database holds (vpr.database-info/1), and its automatic thresholds with the windows from
// which they come (vpr.thresholds/1): as JSON and as tables.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "fabmap/database.h"
#include "present/run_info.h"
#include "present/table.h"
#include "run/thresholds.h"

namespace vpr {

/// `thresholds`: the automatic ones that it holds (stored_thresholds).
Json database_json(const SequenceDatabase& database,
                   const std::vector<AutomaticThresholds>& thresholds, const RunInfo& run);
Json database_json(const FabmapDatabase& database, const RunInfo& run);

/// A table of its sequences, or groups. `name`: of the database.
std::string database_text(const SequenceDatabase& database,
                          const std::vector<AutomaticThresholds>& thresholds,
                          const std::string& name);
std::string database_text(const FabmapDatabase& database, const std::string& name);

/// `thresholds`: one a window length, of the database's sequences.
Json thresholds_json(std::span<const TrainSequence> sequences,
                     const std::vector<AutomaticThresholds>& thresholds, double safety_factor,
                     const RunInfo& run);

/// One row a window length and sequence. `name`: of the database.
Table thresholds_table(std::span<const TrainSequence> sequences,
                       const std::vector<AutomaticThresholds>& thresholds, double safety_factor,
                       const std::string& name);

}  // namespace vpr
