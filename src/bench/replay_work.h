// What is done with each frame of a replay, from its file to what is recognised.
#pragma once

#include "bench/realtime_bench.h"
#include "database/fabmap_database.h"
#include "database/sequence_database.h"
#include "recognition/query_settings.h"

namespace vpr {

/// Describes a frame as the database's are, and does what settings.method does with it: one step of
/// FastABLE over all sequences, of windows of settings.rates if there are any, and the best match
/// of each; or standardized scores and one step of the filter over places and rates. The database
/// must outlive it. Throws Error(usage) for rates that there are not, for the filter if there are
/// rates or the database has no statistics, and where FastABLE's ring takes more than
/// kDefaultMemoryLimit; the work throws Error(data) for frames of another kind than the database's.
FrameWork sequence_work(const SequenceDatabase& database, const RealtimeBenchSettings& settings,
                        const RowKernels& kernels);

/// Features, words, likelihoods and the posterior. The database must outlive it.
FrameWork fabmap_work(const FabmapDatabase& database, const FabmapQuerySettings& settings);

}  // namespace vpr
