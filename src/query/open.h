// Opens what a query needs: its database, with statistics, and its frames.
#pragma once

#include <optional>
#include <string>

#include "database/sequence_database.h"
#include "query/query_settings.h"

namespace vpr {

/// Reads the database at `path` as the settings need it: with statistics for z-scores. Throws what
/// read_sequence_database throws.
SequenceDatabase open_database(const std::string& path, const SequenceQuerySettings& settings,
                               const Monitor& monitor);

/// The same for a live query. Throws Error(data) for a database of imported descriptors, which
/// cannot be computed for frames as they arrive.
SequenceDatabase open_live_database(const std::string& path, const SequenceQuerySettings& settings,
                                    const Monitor& monitor);

/// Warns of the first searched training sequence whose frame rate is not the query's: of windows of
/// several frames if they differ by more than a tenth, since windows then have different durations;
/// of the filter if by more than a factor of 2.05.
void warn_of_rates(const SequenceDatabase& database, std::optional<double> query_fps,
                   const SequenceQuerySettings& settings, const Monitor& monitor);

/// Describes the frames of a query like frames of the database, and warns of rates (warn_of_rates),
/// of other shapes of images, and if they are the frames of a training sequence.
DescriptorSet describe_query(const SequenceArgument& query, const SequenceDatabase& database,
                             const SequenceQuerySettings& settings, const Monitor& monitor);

}  // namespace vpr
