// OpenABLE: the sequence distance by its definition, without re-use from row to row.
#pragma once

#include "matching/rows.h"

namespace vpr {

/// Every cell costs window_length Hamming distances. Rows are computed in parallel. Nothing is
/// produced where a sequence is shorter than a window.
void match_openable(const TrainCodes& train, const QueryCodes& query, const MatchSettings& settings,
                    const Monitor& monitor, const RowConsumer& consume);

}  // namespace vpr
