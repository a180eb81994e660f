// Score matrices that are not a file of scores: of two sets of descriptors, as other programs
// compute them, and of lists of what other programs found.
#pragma once

#include <filesystem>

#include "base/monitor.h"
#include "describe/imported.h"
#include "evaluate/score_matrix.h"
#include "sequence/sequence_source.h"

namespace vpr {

/// Distances of all pairs, computed row by row as they are asked for: of vectors by the
/// metric, with sums of float64 in a fixed order; of uint8 and bool the number of bits that differ.
/// A row that is all NaN has no scores. Throws Error(data) for sequences that are no descriptors,
/// or of different kinds or lengths, and for rows that are no directions (import_descriptors);
/// those of vectors are found while scores are read.
ScoreMatrix descriptor_scores(const SequenceSource& query, const SequenceSource& reference,
                              DescriptorMetric metric = DescriptorMetric::cosine);

/// Reads one of:
/// - a folder with a text file a query, as VPR-methods-evaluation writes them: the query's path,
///   the paths of its predictions, the best first, and those of its positives, which are not looked
///   at, below a line that ends in a colon each;
/// - a text file of "query reference" a line (hloc's list of pairs), the best first for each query;
/// - the same with a third word, a score: of all lines, or of none. Columns of a .csv are separated
///   by commas; a header "query,reference[,score]" may stand above them.
/// Without scores, the rank among the query's references, from 1, is their distance; `kind` is of
/// scores that are there. Of a pair that is listed twice, the better score counts; pairs that are
/// not listed have none. Where frames are called by numbers, there are as many as the largest says.
/// Throws Error(input) for what can't be read; Error(data), naming the line, for what is no such
/// list, an unknown name, or scores without `kind` (Error(usage)).
ScoreMatrix prediction_scores(const std::filesystem::path& path, const FrameNames& queries,
                              const FrameNames& references, std::optional<ScoreOrder> kind);

}  // namespace vpr
