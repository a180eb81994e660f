#pragma once

#include <string>

#include "truth/formats.h"

namespace vpr {

/// Reads a .npy matrix of 0 and 1 (bool, integers or floats) in C or Fortran order, whose rows are
/// query frames, and optionally a second one of the same shape (argument: soft), whose ones are
/// ignored if the first has 0. Or a .npz file with both, named GThard and GTsoft, whose rows are
/// training frames, as in VPR_Tutorial's data sets (Schubert et al. 2023); a .npz file with a
/// single matrix is read like a .npy file. The argument's matrix_rows overrides this, and so does a
/// shape that only fits transposed. Reads row by row, without the whole matrix in memory. Requires
/// exactly one searched sequence. Throws Error(data) for another shape, a value that is neither 0
/// nor 1, or damage.
std::string read_matrix_file(GroundTruthBuilder& builder);

/// Whether it is a .npy file of numbers or a zip archive.
bool is_matrix_file(const FileStart& start);

/// Writes bool matrices: to a .npz file GThard and GTsoft (rows training frames; soft: same or
/// ignored), otherwise a .npy matrix (rows query frames; ignored becomes different).
void write_matrix_file(const InspectedGroundTruth& ground_truth, Output& file,
                       const Monitor& monitor);

}  // namespace vpr
