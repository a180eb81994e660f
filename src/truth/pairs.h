// Ground truth by frame numbers: labeled pairs, anchors with linear interpolation, and aligned
// sequences.
#pragma once

#include <string>

#include "truth/formats.h"

namespace vpr {

/// Header query,reference[,label] or query,sequence,reference[,label]; label "same" (default) or
/// "ignore"; unlisted pairs are different. A frame is a number or, if the scope has names, the name
/// of its file, with or without extension; digits alone are a number. Requires exactly one searched
/// sequence if there is no sequence column. The path may end in a range (pairs.csv@60:111), which
/// selects the query's frames with its step; other pairs are skipped. Throws Error(data), with the
/// line.
std::string read_pairs_csv(GroundTruthBuilder& builder);

bool is_pairs_csv(const FileStart& start);

/// One pair per line, with the tolerance applied; writes the columns sequence and label only if
/// needed.
void write_pairs_csv(const InspectedGroundTruth& ground_truth, Output& file,
                     const Monitor& monitor);

/// A CSV query,reference or query,sequence,reference: anchors, with increasing query frames for
/// each training sequence. A query frame between two neighboring anchors of a sequence is at the
/// training frame found by linear interpolation, rounded (ties up); before the first and after the
/// last anchor it has no place. `same` are training frames within the tolerance and, if the
/// argument has a `reference` (poses of the training sequence, a CSV frame,x,y or a trajectory) and
/// a radius, all frames within that many meters of the interpolated position; training frames
/// without a pose are then ignored. A range after the path is the range of the query. Throws
/// Error(data), with the line, for query frames that do not increase and for frames out of range;
/// Error(usage) for a radius without poses, or poses without a radius.
std::string read_anchors(GroundTruthBuilder& builder);

/// Whether the file name ends in anchors.csv and the file has the header of pairs.
bool is_anchors_csv(const FileStart& start);

/// Query frame i is training frame step * i (argument: reference_step, default 1), rounded to
/// nearest, ties up. Frames beyond the training sequence match its end within the tolerance.
/// Requires exactly one searched sequence.
std::string read_aligned(GroundTruthBuilder& builder);

}  // namespace vpr
