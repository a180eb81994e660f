// A few pairs of frames "the same place here", and what lies between them.
#pragma once

#include "ground_truth/formats.h"

namespace vpr {

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

}  // namespace vpr
