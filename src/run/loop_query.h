// A walk against its own past: what takes the place of a database, and what it is asked for.
#pragma once

#include "decide/query_settings.h"
#include "evaluate/loops.h"
#include "store/sequence_database.h"

namespace vpr {

/// The walk described by settings.descriptor, or where that is empty by LDB, or as vectors where
/// its frames are arrays. Throws as describe_frames does.
DescriptorSet describe_walk(const SequenceSource& walk, const SequenceQuerySettings& settings,
                            const Monitor& monitor);

/// The query as the only training sequence, of its name; nothing is learned from it.
SequenceDatabase own_walk(const DescriptorSet& query, const std::string& name);

/// The gap of a walk against its own past.
LoopGap loop_gap_of(const SequenceQuerySettings& settings);

}  // namespace vpr
