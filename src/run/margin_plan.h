// What a margin needs to know of a database: what is elsewhere, and which margin is enough.
#pragma once

#include "run/query.h"

namespace vpr {

/// Half-widths and shared places of training sequences that a database is written with. Those that
/// it has already are kept.
void add_half_widths(SequenceDatabase& database, const Monitor& monitor);
void add_shared_places(SequenceDatabase& database, const RowKernels& kernels,
                       const Monitor& monitor);

/// Adds both.
void ensure_places(SequenceDatabase& database, const RowKernels& kernels, const Monitor& monitor);

/// By the settings margin_width and same_place, else by what the database holds, else computed.
/// Throws Error(usage) for a same_place that is no pair of its sequences.
Elsewhere plan_elsewhere(const SequenceDatabase& database, const SequenceQuerySettings& settings,
                         const RowKernels& kernels, const Monitor& monitor);

/// Sets the margin of every target of a decision by margin: the setting, or the automatic
/// one of its sequence. The plan knows what is elsewhere.
void plan_margins(QueryPlan& plan, const SequenceDatabase& database,
                  const QueryResources& resources, const Monitor& monitor);

}  // namespace vpr
