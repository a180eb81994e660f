// OpenABLE: the sequence distance by its definition, without re-use from row to row.
#pragma once

#include "matching/rows.h"

namespace vpr {

/// Every cell costs window_length frame distances, which must not come in order. Rows are computed
/// in parallel. Nothing is produced where a sequence is shorter than a window.
void match_openable(const FrameDistances& distances, const MatchSettings& settings,
                    const Monitor& monitor, const RowConsumer& consume);

}  // namespace vpr
