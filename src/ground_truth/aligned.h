// Sequences that show the same place at the same time.
#pragma once

#include <string>

namespace vpr {

class GroundTruthBuilder;

/// Query frame i is training frame step * i (argument: reference_step, default 1), rounded to the
/// nearest, halves up. Frames of a query that is longer match the training sequence's end, within
/// the tolerance. Exactly one searched sequence.
std::string read_aligned(GroundTruthBuilder& builder);

}  // namespace vpr
