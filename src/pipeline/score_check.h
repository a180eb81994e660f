// Settings that do not go together with the score.
#pragma once

#include "recognition/sequence_result.h"

namespace vpr {

/// Throws Error(usage) where t_r, its scale, the method, c_l or the settings of either score do not
/// fit the score.
void check_score(const SequenceQuerySettings& settings);

}  // namespace vpr
