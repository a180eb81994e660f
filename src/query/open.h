// Opens what a query needs: its database, with statistics and exclusion zones, and its frames.
#pragma once

#include <optional>
#include <string>

#include "database/sequence_database.h"
#include "query/exclusion_zones.h"
#include "query/query_settings.h"

namespace vpr {

/// Whether the settings search this training sequence.
bool is_searched(const SequenceQuerySettings& settings, const std::string& sequence);

/// Throws Error(usage) for a sequence of the settings that the database lacks.
void check_names(const SequenceDatabase& database, const SequenceQuerySettings& settings);

/// Throws Error(usage) if sums over a window may exceed the signed 32-bit integers of files.
void check_sums(const DescriptorStore& descriptors, uint64_t window_length);

/// Adds the initial statistics of z-scores: the components of the training frames, which are not
/// stored, and statistics by default settings if the database has none.
void ensure_statistics(SequenceDatabase& database, const Monitor& monitor);

/// Adds statistics (ensure_statistics), the exclusion radius of each sequence, the pairs of
/// overlapping sequences and the repeated places, unless the database has them.
void ensure_exclusion_zones(SequenceDatabase& database, const Monitor& monitor);

/// The exclusion zones of this radius and these declared pairs, or else those of the database,
/// computed if it has none. Throws Error(usage) for declared pairs that are not training sequences.
ExclusionZones exclusion_zones_of(const SequenceDatabase& database,
                                  const std::optional<uint64_t>& radius,
                                  const std::vector<std::string>& same_place,
                                  const Monitor& monitor);

/// The repeated places of the database, computed if it has none. The database has statistics with
/// components.
std::vector<RepeatedPlace> repeated_places(const SequenceDatabase& database,
                                           const Monitor& monitor);

/// Reads the database at `path` as the settings need it: with statistics for z-scores. Throws what
/// read_sequence_database throws.
SequenceDatabase open_database(const std::string& path, const SequenceQuerySettings& settings,
                               const Monitor& monitor);

/// The same for a live query. Throws Error(data) for a database of imported descriptors, which
/// cannot be computed for frames as they arrive.
SequenceDatabase open_live_database(const std::string& path, const SequenceQuerySettings& settings,
                                    const Monitor& monitor);

/// Adds what the settings need to a database that was read or trained, as open_database does.
void prepare_database(SequenceDatabase& database, const SequenceQuerySettings& settings,
                      const Monitor& monitor);

/// Warns of the first searched training sequence whose frame rate is not the query's: of windows of
/// several frames if they differ by more than a tenth, since windows then have different durations;
/// of the filter if by more than a factor of 2.05.
void warn_of_rates(const SequenceDatabase& database, std::optional<double> query_fps,
                   const SequenceQuerySettings& settings, const Monitor& monitor);

/// Describes the frames of a query like frames of the database, and warns (warn_of_rates).
DescriptorSet describe_query(const SequenceArgument& query, const SequenceDatabase& database,
                             const SequenceQuerySettings& settings, const Monitor& monitor);

}  // namespace vpr
