// Ground truths by frame numbers: labeled pairs, anchors with straight lines between them, aligned
// sequences.
#pragma once

#include <string>

#include "truth/formats.h"

namespace vpr {

/// Header query,reference[,label] or query,sequence,reference[,label]; label "same" (default) or
/// "ignore"; pairs that are not listed are different. A frame is its number, or, where the scope
/// knows names, the name of its file, with or without extension; digits alone are a number. Without
/// a sequence column, exactly one searched sequence. The path may end in a range
/// (pairs.csv@60:111), of which the query's frames count, in its steps; pairs of others are left
/// out. Throws Error(data), naming the line.
std::string read_pairs_csv(GroundTruthBuilder& builder);

bool is_pairs_csv(const FileStart& start);

/// One line a pair, tolerance applied; columns sequence and label only where they say something.
void write_pairs_csv(const InspectedGroundTruth& ground_truth, Output& file,
                     const Monitor& monitor);

/// A CSV query,reference or query,sequence,reference with the lines of each training sequence in
/// the order of rising query frames: anchors. A query frame between two neighbouring anchors of a
/// sequence is at the training frame on the straight line between them, rounded (halves up); in
/// front of the first and behind the last anchor it is nowhere. `same` are the training frames that
/// are at most the tolerance away, and, where the argument has a `reference` (poses of the training
/// sequence, a CSV frame,x,y or a trajectory) and a radius, all that are within so many metres of
/// the position there; training frames without a pose are to be ignored then. A range behind the
/// path is that of the query. Throws Error(data), naming the line, for query frames that repeat or
/// fall and for frames out of range; Error(usage) for a radius without poses, or poses without one.
std::string read_anchors(GroundTruthBuilder& builder);

/// Whether it is called anchors.csv, or something that ends so, and has the header of pairs.
bool is_anchors_csv(const FileStart& start);

/// Query frame i is training frame step * i (argument: reference_step, default 1), rounded to the
/// nearest, halves up. Frames of a query that is longer match the training sequence's end, within
/// the tolerance. Exactly one searched sequence.
std::string read_aligned(GroundTruthBuilder& builder);

}  // namespace vpr
