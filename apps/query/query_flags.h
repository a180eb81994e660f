// What the flags of vpr-query set.
#pragma once

#include "decide/query_settings.h"
#include "query_inputs.h"

namespace vpr {

inline constexpr const char* kSequenceGroup = "FastABLE and OpenABLE";
inline constexpr const char* kScoreGroup = "A matrix of scores";
inline constexpr const char* kFabmapGroup = "FAB-MAP";

/// The database, and where the query comes from.
void add_inputs(const Command& app, QueryInputs& inputs);

/// Flags that a database of sequences understands.
void add_sequence_flags(const Command& app, QueryInputs& inputs, SequenceQuerySettings& settings);

/// Flags of a query against its own past, by either family.
void add_loop_flags(const Command& app, QueryLoop& loop, SequenceQuerySettings& sequence,
                    FabmapQuerySettings& fabmap);

/// Flags that a database of FAB-MAP understands.
void add_fabmap_flags(const Command& app, QueryInputs& inputs, FabmapQuerySettings& settings);

}  // namespace vpr
