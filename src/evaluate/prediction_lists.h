// Lists of matched frames: read from other programs as scores, and written from scores or results.
#pragma once

#include <filesystem>

#include "evaluate/score_matrix.h"

namespace vpr {

/// Reads one of:
/// - a folder with one text file per query, in the format of VPR-methods-evaluation: the query's
///   path, the paths of its predictions, best first, and those of its positives, which are skipped,
///   each after a line that ends in a colon;
/// - a text file with one "query reference" pair per line (hloc), best first per query;
/// - the same text file with a score as the third word of every line. The columns of a .csv are
///   separated by commas; its header "query,reference[,score]" is optional.
/// Without scores, the rank among the references of the query, from 1, is the distance; `kind`
/// applies to listed scores. If a pair is repeated, the better score counts; other pairs have no
/// score. If frames have numbers instead of names, the largest one determines how many there are.
/// Throws Error(input) for a file that cannot be read; Error(data), with the line, for another
/// format or an unknown name; Error(usage) for scores without `kind`.
ScoreMatrix prediction_scores(const std::filesystem::path& path, const FrameNames& queries,
                              const FrameNames& references, std::optional<ScoreOrder> kind);

/// A query frame and a frame of a training sequence: anchors of windows.
struct BestPair {
  size_t query = 0;
  FrameMatch match;

  bool operator==(const BestPair&) const = default;
};

/// By query, its `most` best references with a score, best first, ties to the first column. Throws
/// as ScoreMatrix::for_each_row does.
std::vector<BestPair> best_pairs(const ScoreMatrix& matrix, const ScoreLayout& layout, size_t most,
                                 const Monitor& monitor);

/// The best matches of a result.
std::vector<BestPair> best_pairs(const Result& result);

}  // namespace vpr
