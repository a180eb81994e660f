// What to say if a query recognizes nothing, or everything.
#pragma once

#include <optional>
#include <string>

#include "pipeline/query.h"

namespace vpr {

/// One sentence if more than a fifth of all window pairs of a result are hits.
std::optional<std::string> too_many_hits(const Result& result);

/// One sentence on a result without hits, from its settings alone.
std::string nothing_recognized(const Result& result);

/// One sentence on a query whose windows recognize nothing: how many of its frames the method
/// filter recognizes, with default settings and the same training sequences, and the median of
/// their speeds. The database has statistics (ensure_statistics).
std::string filter_finding(const SequenceDatabase& database, const DescriptorSet& query,
                           const SequenceQuerySettings& settings, const QueryResources& resources,
                           const Monitor& monitor);

}  // namespace vpr
