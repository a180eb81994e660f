// What standardized scores of a database start from, and distances as either score takes them.
#pragma once

#include "database/sequence_database.h"
#include "matching/standardization.h"
#include "pipeline/query.h"

namespace vpr {

/// Gives a database of older date the training statistics that it lacks, with default settings, and
/// says so. Nothing happens to one that has them.
void ensure_statistics(SequenceDatabase& database, const Monitor& monitor);

/// For all sequences of the database; none for a score that needs no statistics. Throws
/// Error(usage) if the database has none.
std::optional<ScoreBasis> score_basis(const SequenceDatabase& database,
                                      const SequenceQuerySettings& settings);

/// The distances of the searched sequences as a planned result scores them: standardized, or as
/// they are. Throws what score_basis and start_standardized throw.
FrameDistances scored(FrameDistances distances, const QueryPlan& result,
                      const SequenceDatabase& database, const Monitor& monitor);

}  // namespace vpr
