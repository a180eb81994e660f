// Ground truth as a MATLAB matrix.
#pragma once

#include "ground_truth/formats.h"

namespace vpr {

/// A .mat file (of MATLAB's versions 5 to 7.3) whose only matrix of numbers, or the one called
/// truth, has ones where frames show the same place and zeros elsewhere, full or sparse; scalars
/// and what is no matrix are passed over. Rows are query frames, unless the argument or the numbers
/// of frames say otherwise. Throws Error(data), naming the variable, for other values and for a
/// file that is damaged.
std::string read_mat_file(GroundTruthBuilder& builder);

/// Whether it says that it is a MAT-file, or is called so.
bool is_mat_file(const FileStart& start);

}  // namespace vpr
