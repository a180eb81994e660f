// Advice for a query that recognizes nothing, or everything.
#pragma once

#include <optional>
#include <string>

#include "run/query.h"

namespace vpr {

/// A sentence if more than a fifth of all window pairs of a result are recognitions.
std::optional<std::string> excess_advice(const Result& result);

/// A sentence about a result without recognitions, from its settings alone.
std::string no_recognition_advice(const Result& result);

/// A sentence about a query whose windows recognize nothing: the number of its frames that the
/// method filter recognizes with default settings and the same training sequences, and their median
/// speed. The database has statistics (ensure_statistics).
std::string filter_advice(const SequenceDatabase& database, const DescriptorSet& query,
                          const SequenceQuerySettings& settings, const QueryResources& resources,
                          const Monitor& monitor);

}  // namespace vpr
