// A query by a sequence method: the block diagram of OpenABLE and FastABLE (paper, figure 1 B).
#pragma once

#include <map>
#include <string>
#include <vector>

#include "decide/choices.h"
#include "decide/result.h"
#include "match/match.h"
#include "store/sequence_database.h"

namespace vpr {

/// What does not change the result.
struct QueryResources {
  RowKernels kernels;
  size_t memory_limit = kDefaultMemoryLimit;  ///< bytes for rings and recognitions
  size_t verify_cells = 0;                    ///< recompute so many cells by definition
  uint64_t seed = 1;                          ///< of their choice
};

/// A result, and how long each step took.
struct QueryRun {
  Result result;
  std::map<std::string, double> seconds;  ///< by step
  size_t verified_cells = 0;
};

/// The database at `path` as the settings need it: with statistics for z-scores, and
/// fused with FAB-MAP's database at `fabmap` unless that is empty. Warns of an automatic margin of
/// fused scores. Throws what read_sequence_database, check_automatic and fuse_views throw, and
/// Error(data) for a database of imported descriptors that cannot describe frames as they arrive.
SequenceDatabase open_database(const std::string& path, const ResolvedSettings& settings,
                               const std::string& fabmap, const Monitor& monitor);

/// The frames of a query, described like those of the database. Warns of a frame rate that differs
/// from the training sequences' (warn_of_rates).
DescriptorSet describe_query(const SequenceArgument& query, const SequenceDatabase& database,
                             const ResolvedSettings& settings, const Monitor& monitor);

/// Thresholds and the shape of a query, before any distance is known. Throws Error(usage) for
/// an unknown sequence name, and a query or training sequences that are all shorter than a window,
/// and Error(data) for descriptors of different kinds. Computes automatic
/// thresholds that the database lacks. Database and query must outlive the plan.
QueryPlan plan_query(const SequenceDatabase& database, const DescriptorSet& query,
                     const std::string& query_name, const ResolvedSettings& settings,
                     const QueryResources& resources, const Monitor& monitor);

/// The same of a walk against its own past; `walk` is own_walk() of the query. `times_ns`: of its
/// frames, rising, where the gap is one of time.
QueryPlan plan_loop(const SequenceDatabase& walk, const DescriptorSet& query,
                    const std::string& query_name, const ResolvedSettings& settings,
                    std::span<const int64_t> times_ns, const QueryResources& resources,
                    const Monitor& monitor);

/// The same of any one window of a query that is described as the database is, before a frame of it
/// is known.
QueryPlan plan_window(const SequenceDatabase& database, const std::string& query_name,
                      const ResolvedSettings& settings, const QueryResources& resources,
                      const Monitor& monitor);

/// Distances, recognitions, best matches and clusters of a planned query. Every row also goes to
/// `observers`. Throws Error(expectation) if a verified cell differs, and what score_basis
/// and start_zscores throw.
QueryRun run_query(QueryPlan plan, const QueryResources& resources, const Sinks& observers,
                   const Monitor& monitor);

}  // namespace vpr
