// Ground truth as a picture of the matrix.
#pragma once

#include "ground_truth/formats.h"

namespace vpr {

/// Rows are query frames, columns training frames (argument: matrix_rows); 255 is the same place, 0
/// is not, and anything between is ignored, as in the masks of FAB-MAP's data sets. Colours count
/// by their grey. Exactly one searched sequence. Throws Error(data) for another size, or for a
/// JPEG, whose values are not what was drawn.
std::string read_mask_image(GroundTruthBuilder& builder);

/// Whether a file starts as a picture does; also as a JPEG, so that its reader can refuse it.
bool is_mask_image(const FileStart& start);

/// A PNG; 128 is ignored.
void write_mask_image(const InspectedGroundTruth& ground_truth, OutputFile& file,
                      const Monitor& monitor);

}  // namespace vpr
