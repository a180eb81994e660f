// What to say if a query recognizes nothing, or everything, or has another frame rate.
#pragma once

#include <optional>
#include <string>

#include "base/monitor.h"
#include "decide/query_settings.h"
#include "run/query.h"
#include "store/sequence_database.h"

namespace vpr {

/// One sentence if more than a fifth of all window pairs of a result are recognitions.
std::optional<std::string> too_many_recognitions(const Result& result);

/// One sentence on a result without recognitions, from its settings alone.
std::string nothing_recognized(const Result& result);

/// One sentence on a query whose windows recognize nothing: how many of its frames the method
/// filter recognizes, with default settings and the same training sequences, and the median of
/// their speeds. The database has statistics (ensure_statistics).
std::string filter_finding(const SequenceDatabase& database, const DescriptorSet& query,
                           const SequenceQuerySettings& settings, const QueryResources& resources,
                           const Monitor& monitor);

/// Warns once where a training sequence that is searched has another rate than the query, by more
/// than a tenth, both known: windows compare as many frames of one as of the other. Of single
/// frames, of windows of several rates, and of the filter, which finds the rate, it does not.
void warn_of_rates(const SequenceDatabase& database, std::optional<double> query_fps,
                   const SequenceQuerySettings& settings, const Monitor& monitor);

}  // namespace vpr
