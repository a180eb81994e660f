// Ground truth as a NumPy matrix.
#pragma once

#include <string>

#include "truth/formats.h"

namespace vpr {

/// A .npy matrix of 0 and 1 (bool, integers or floats), C or Fortran order, rows query frames; and
/// a second one of the same shape (argument: soft) whose ones are to be ignored where the first has
/// 0. Or a .npz file with both, under the names GThard and GTsoft, whose rows are training frames,
/// as in VPR_Tutorial's data sets (Schubert et al. 2023); one with a single matrix is taken like a
/// .npy file. The argument's matrix_rows overrides, and so does a shape that fits only the other
/// way. Read row by row: a large matrix is never whole in memory. Exactly one searched sequence.
/// Throws Error(data) for another shape, a value that is neither 0 nor 1, or damage.
std::string read_matrix_file(GroundTruthBuilder& builder);

/// A .npy file of numbers, or a zip archive.
bool is_matrix_file(const FileStart& start);

/// Writes bool matrices: .npz (GThard and GTsoft, rows training frames; soft: same or ignored), or,
/// by any other name, .npy (rows query frames; what is ignored becomes different).
void write_matrix_file(const InspectedGroundTruth& ground_truth, Output& file,
                       const Monitor& monitor);

}  // namespace vpr
