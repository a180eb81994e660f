// What a database holds (vpr.database-info/1), for scripts and for people.
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "database/fabmap_database.h"
#include "pipeline/thresholds.h"
#include "report/run_info.h"

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

}  // namespace vpr
