// Databases of queries that have none: a sequence against its own past, and a score matrix.
#pragma once

#include "match/precomputed_distances.h"
#include "run/train_sequences.h"
#include "settings/query_settings.h"
#include "store/sequence_database.h"

namespace vpr {

/// Describes a sequence by settings.descriptor; if this is empty, by LDB, or as vectors if its
/// frames are arrays. Throws as describe_frames does.
DescriptorSet describe_own(const SequenceSource& sequence, const SequenceQuerySettings& settings,
                           const Monitor& monitor);

/// A database with the query as the only training sequence, without training statistics.
SequenceDatabase own_database(const DescriptorSet& query, const std::string& name);

/// A score matrix as a query and a database.
struct MatrixQuery {
  SequenceDatabase database;
  DescriptorSet query;
};

/// The rows of a matrix as query frames, its columns as training frames: all columns as one
/// sequence, "references", or the ranges of columns in `sequences`. Frames without any score are
/// unreadable. Z-scores start without bias, from the variance of the first readable query frame's
/// distances; every frame is a keyframe. Automatic thresholds and exclusion radii are unknown.
/// `matrix` must outlive the result. Throws Error(usage) for a range outside the matrix and for
/// duplicate names.
MatrixQuery matrix_query(const PrecomputedDistances& matrix,
                         const std::vector<NamedArgument>& sequences);

}  // namespace vpr
