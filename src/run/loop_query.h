// A walk against its own past: what takes the place of a database, and what it is asked for.
#pragma once

#include "decide/query_settings.h"
#include "store/sequence_database.h"
#include "truth/loop_list.h"

namespace vpr {

/// The walk described by settings.descriptor, which then has a name. Throws as describe_frames
/// does.
DescriptorSet describe_walk(const Sequence& walk, SequenceQuerySettings& settings,
                            const Monitor& monitor);

/// The query as the only training sequence, of its name; nothing is learned from it.
SequenceDatabase own_walk(const DescriptorSet& query, const std::string& name);

/// The gap of a walk against its own past, whose settings were checked.
LoopGap loop_gap_of(const SequenceQuerySettings& settings);

/// Throws Error(usage) for settings by which what is said of a frame would depend on later ones,
/// and for methods that do not see every window by itself.
void check_loop(const SequenceQuerySettings& settings);

/// Throws Error(usage) for a walk against its own past, where there is a database.
void refuse_loop(const SequenceQuerySettings& settings);

}  // namespace vpr
