// The bound of FAB-MAP's fast bail-out.
#pragma once

#include "matching/fabmap.h"

namespace vpr {

/// How far a view must be behind the best so that, by Bennett's inequality, sums of the remaining
/// terms make it good with probability 1e-6 at most. `variance`: of the sum of the remaining
/// log-likelihood ratios; `largest`: their largest step. At least -ln 1e-6.
double bail_out_gap(double variance, double largest);

}  // namespace vpr
