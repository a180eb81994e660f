// Databases (vpr.database-info/3) and their automatic thresholds (vpr.thresholds/3) as JSON and
// tables.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "present/table.h"
#include "query/run_info.h"
#include "query/thresholds.h"

namespace vpr {

Json database_json(const SequenceDatabase& database, const RunInfo& run);

/// A table of sequences.
std::string database_text(const SequenceDatabase& database, const std::string& name);

/// Thresholds by window length and sequence, with the frames that determine them.
Json thresholds_json(std::span<const TrainSequence> sequences,
                     const std::vector<ThresholdTable>& thresholds, double safety_factor,
                     const RunInfo& run);
Json sequence_info_schema();
Json thresholds_schema();

/// A row per window length and sequence. `name`: of the database.
Table thresholds_table(std::span<const TrainSequence> sequences,
                       const std::vector<ThresholdTable>& thresholds, double safety_factor,
                       const std::string& name);

}  // namespace vpr
