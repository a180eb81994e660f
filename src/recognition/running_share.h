// A threshold that is carried over to another walk by the scores of that walk.
#pragma once

#include "recognition/result.h"

namespace vpr {

/// Leaves of the hits of a query those that are also closer than most of what is elsewhere in this
/// query so far: with the scores elsewhere (the best match's and its margin) of all windows up to
/// the hit's own one in rising order, those below the one at index floor(share * (n - 1)). Where
/// walks differ in light or noise, their scores do, and a share of them means the same in each.
/// Windows without a margin have nothing elsewhere; hits in front of the first one that has stay.
void limit_by_share(Result& result, double share);

}  // namespace vpr
