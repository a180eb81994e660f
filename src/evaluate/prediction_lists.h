// What other programs found, as lists: for each query the references that it was taken for.
#pragma once

#include <filesystem>

#include "evaluate/score_matrix.h"
#include "sequence/sequence.h"

namespace vpr {

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
