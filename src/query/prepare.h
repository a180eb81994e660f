// Everything about a database that plans read, computed once: what is not stored in it.
#pragma once

#include <optional>
#include <vector>

#include "database/sequence_database.h"
#include "query/exclusion_zones.h"
#include "query/query_settings.h"

namespace vpr {

/// Resources of a query. Only the method lsh has other results for another seed.
struct QueryResources {
  size_t memory_limit = kDefaultMemoryLimit;  ///< bytes for rings and recognitions
  uint64_t seed = 1;                          ///< of lsh and intervals
};

/// A database as the queries of one rule need it. Points into the database.
struct PreparedDatabase {
  const SequenceDatabase* database;    ///< with statistics if scores need them
  std::vector<DescribedFrames> train;  ///< all sequences, also those that are not searched
  std::optional<ExclusionZones> exclusion_zones = {};  ///< nullopt: no margins
  std::vector<RepeatedPlace> passes = {};              ///< of the filter
  std::vector<double> typical_distances = {};     ///< by sequence, for default margins; else empty
  std::optional<ThresholdTable> thresholds = {};  ///< for an automatic t_r
};

/// Adds the initial statistics of z-scores: the components of the training frames, which are not
/// stored, and statistics by default settings if the database has none.
void ensure_statistics(SequenceDatabase& database, const Monitor& monitor);
/// The same if the settings need it.
void ensure_statistics(SequenceDatabase& database, const SequenceQuerySettings& settings,
                       const Monitor& monitor);

/// Adds statistics (ensure_statistics), the exclusion radius of each sequence, the pairs of
/// overlapping sequences and the repeated places, unless the database has them.
void ensure_exclusion_zones(SequenceDatabase& database, const Monitor& monitor);

/// Throws Error(usage) if sums over a window may exceed the signed 32-bit integers of files.
void check_sums(const DescriptorStore& descriptors, uint64_t window_length);

/// Computes what the rule needs and the database lacks. Throws what check_settings throws,
/// Error(usage) for names of sequences that the database lacks, windows whose sums do not fit, and
/// an automatic t_r with one sequence. The database has statistics (open_database) for z-scores.
PreparedDatabase prepare(const SequenceDatabase& database, const SequenceQuerySettings& settings,
                         const QueryResources& resources = {}, const Monitor& monitor = {});

}  // namespace vpr
