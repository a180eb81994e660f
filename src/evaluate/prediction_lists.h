// Lists of matched frames: read from other programs as scores, and written from scores or results.
#pragma once

#include <filesystem>

#include "evaluate/score_matrix.h"

namespace vpr {

/// The numbers of frames, where they are known.
struct ListFrames {
  std::optional<size_t> query;
  std::optional<size_t> train;
};

/// Reads one of:
/// - a folder with one text file per query, in the format of VPR-methods-evaluation: the query's
///   path, the paths of its predictions, best first, and those of its positives, which are skipped,
///   each after a line that ends in a colon;
/// - a text file with one "query reference" pair per line (hloc), best first per query;
/// - the same with a score in every line;
/// - a text file with one line per query: its name and those of its references, best first. It
///   needs a header if each query may also be a reference: lines may then lack their query.
/// Fields are separated by commas, semicolons or tabs (kapture, CSV) if the first line has one,
/// otherwise by blanks. Lines that begin with # are skipped. A header has the columns query,
/// reference and optionally the score (distance or similarity state its order, rank is none), or of
/// a ranking query and more than two others. Without scores, the rank among the references of the
/// query, from 1, is the distance; `kind` applies to listed scores. If a pair is repeated, the
/// better score counts; other pairs have no score. Fields that are all numbers are numbers of
/// frames unless find_names decides otherwise; if neither names nor `stated` tell how many there
/// are, the largest one does. Throws Error(input) for a file that cannot be read; Error(data), with
/// the line, for another format or an unknown name; Error(usage) for scores without `kind` or
/// against the header.
ScoreMatrix prediction_scores(const std::filesystem::path& path, const FrameNames& queries,
                              const FrameNames& references, std::optional<ScoreOrder> kind,
                              const ListFrames& stated = {}, const Monitor& monitor = {});

/// Whether the array has rows of integers that are fewer than the references: the indices of the
/// best references of each query, as faiss returns them.
bool is_index_array(const NpyArray& array, size_t references);

/// The ranks of the indices; -1 is none. Throws Error(data) for an index out of range.
ScoreMatrix index_scores(ScoreFile indices, size_t references);

/// By query, its `most` best references with a score, best first, ties to the first column. Throws
/// as ScoreMatrix::for_each_row does.
std::vector<MatchedFrame> best_pairs(const ScoreMatrix& matrix, const ScoreLayout& layout,
                                     size_t most, const Monitor& monitor);

/// The best matches of a result.
std::vector<MatchedFrame> best_pairs(const Result& result);

}  // namespace vpr
