// A query by multi-probe locality-sensitive hashing: approximate, with its recall.
#pragma once

#include "run/query.h"

namespace vpr {

/// Recognitions and best matches among the windows that share a hash bucket with a query window,
/// with their exact distances; the recall of the search against FastABLE; clusters. The result has
/// no margins. Throws Error(usage) for descriptors that are not binary, and what plan_query throws.
QueryRun query_lsh(const SequenceDatabase& database, const DescriptorSet& query,
                   const std::string& query_name, const ResolvedSettings& settings,
                   const QueryResources& resources, const Monitor& monitor);

}  // namespace vpr
