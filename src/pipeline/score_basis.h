// What standardized scores of a database start from, and rows of either kind of score.
#pragma once

#include "database/sequence_database.h"
#include "matching/fastable_batch.h"
#include "pipeline/query.h"

namespace vpr {

/// Gives a database of older date the training statistics that it lacks, with default settings, and
/// says so. Nothing happens to one that has them.
void ensure_statistics(SequenceDatabase& database, const HammingKernels& kernels,
                       const Monitor& monitor);

/// For all sequences of the database; none for a score that needs no statistics. Throws
/// Error(usage) if the database has none.
std::optional<ScoreBasis> score_basis(const SequenceDatabase& database,
                                      const SequenceQuerySettings& settings);

/// How close training sequences come to each other, by the score that is set; settings give c_l.
ThresholdTable closest_windows(const SequenceDatabase& database,
                               const SequenceQuerySettings& settings, const MatchSettings& match,
                               const Monitor& monitor);

/// Matches the rows of a planned result, several window lengths in one pass. Raw distances come
/// from `raw`, standardized scores of the searched sequences from FastABLE's recurrence.
/// settings.window_length does not matter to the latter.
using RawMatcher = std::function<void(const LengthRowConsumer&)>;
void match_rows(const SequenceResult& result, const SequenceDatabase& database,
                const TrainCodes& train, const QueryCodes& query,
                std::span<const size_t> window_lengths, const MatchSettings& settings,
                const Monitor& monitor, const RawMatcher& raw, const LengthRowConsumer& consume);

}  // namespace vpr
