// A matrix of scores as a query and a database, of which only distances are known.
#pragma once

#include "match/given_distances.h"
#include "run/train.h"
#include "store/sequence_database.h"

namespace vpr {

/// What plan_query takes.
struct GivenQuery {
  SequenceDatabase database;
  DescriptorSet query;
};

/// All queries of a matrix against its references, or those that `sequences` name by ranges of
/// numbers; none: all are one sequence, "references". Frames without any score can't be read.
/// Z-scores start without any bias, from how far the first readable frame's distances
/// spread, and every frame is a view. Thresholds and half-widths are not known. The matrix must
/// outlive what is returned. Throws Error(usage) for a range that it does not have, and for names
/// that are used twice.
GivenQuery given_query(const GivenDistances& given, const std::vector<NamedArgument>& sequences);

}  // namespace vpr
