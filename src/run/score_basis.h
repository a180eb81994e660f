// What z-scores of a database start from, and distances as either score takes them.
#pragma once

#include "match/zscore_model.h"
#include "run/query.h"
#include "store/sequence_database.h"

namespace vpr {

/// Gives a database what z-scores start from: the components of its training frames,
/// which are not stored, and statistics by default settings where it has none. Throws
/// Error(interrupted) once the user wants to stop.
void ensure_statistics(SequenceDatabase& database, const Monitor& monitor);

/// For all sequences of a database; none for a score that needs no statistics, and for a walk
/// against its own past, which has none. `learned`: the
/// database's, with components, or null. Throws Error(usage) if they are needed and it has none.
std::optional<ScoreBasis> score_basis(const TrainStatistics* learned,
                                      const SequenceQuerySettings& settings);

/// Distances as a plan scores them: standardized by `basis`, or as they are. Throws what
/// start_zscores throws.
FrameDistances scored(FrameDistances distances, const std::optional<ScoreBasis>& basis,
                      const QueryPlan& plan, const Monitor& monitor);

}  // namespace vpr
