// What to do where query and training sequences have other rates.
#pragma once

#include <optional>

#include "base/monitor.h"
#include "database/sequence_database.h"
#include "recognition/query_settings.h"

namespace vpr {

/// Warns once where a training sequence that is searched has another rate than the query, by more
/// than a tenth, both known: windows compare as many frames of one as of the other. Of single
/// frames, of windows of several rates, and of the filter, which finds the rate, it does not.
void warn_of_rates(const SequenceDatabase& database, std::optional<double> query_fps,
                   const SequenceQuerySettings& settings, const Monitor& monitor);

}  // namespace vpr
