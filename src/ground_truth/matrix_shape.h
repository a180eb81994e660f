// Which side of a matrix is the query.
#pragma once

#include <cstddef>

namespace vpr {

class GroundTruthBuilder;

/// Whether the rows are query frames: as the argument's matrix_rows says; else `usually`, unless
/// only the other way fits the numbers of frames. Throws Error(data) if the shape does not fit.
bool require_matrix_shape(GroundTruthBuilder& builder, size_t sequence, size_t rows, size_t cols,
                          bool usually);

}  // namespace vpr
