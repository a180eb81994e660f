// Queries whose cells are compared with reference implementations, for every kind of score.
#pragma once

#include "query/run_query.h"

namespace vpr::test {

/// run_query, with up to `cells` random cells compared with their reference: raw and z-scores,
/// and of a sequence against its own past only cells of the past. Fails the test case if a cell
/// differs.
QueryRun run_verified(const QueryPlan& plan, size_t cells, const Monitor& monitor = {});

}  // namespace vpr::test
