// Scores of all pairs of two sets of descriptors, as other programs compute them: in float64.
#pragma once

#include "base/monitor.h"
#include "describe/imported.h"
#include "evaluate/score_matrix.h"
#include "sequence/sequence.h"

namespace vpr {

/// Distances of all pairs, computed row by row as they are asked for: of vectors by the
/// metric, with sums of float64 in a fixed order; of uint8 and bool the number of bits that differ.
/// A row that is all NaN has no scores. Throws Error(data) for sequences that are no descriptors,
/// or of different kinds or lengths, and for rows that are no directions (import_descriptors);
/// those of vectors are found while scores are read.
ScoreMatrix descriptor_scores(const Sequence& query, const Sequence& reference,
                              DescriptorMetric metric = DescriptorMetric::cosine);

}  // namespace vpr
