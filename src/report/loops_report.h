// Loop closures against a trajectory, as JSON (vpr.loops/1) and for people.
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "evaluation/loops.h"
#include "report/run_info.h"
#include "report/table.h"

namespace vpr {

/// Everything that was judged, with what it was called and judged by.
struct LoopsEvaluation {
  std::string name;
  LoopList list;
  Trajectory trajectory;
  LoopRules rules;
  LoopJudgement judgement;
};

/// Everything of a report but "machine" and "timing".
Json loops_json(const LoopsEvaluation& evaluation, const RunInfo& run);

/// "17 of 20 revisits are found, and 3 of 190 loops are wrong."
std::string loops_sentence(const Json& report);

/// One row: loops, frames and revisits, and with scores the metrics of the curve.
Table loops_table(const Json& report);

/// The revisits that nobody found and the loops that are wrong, the first 20 of each; empty where
/// there are none.
std::string loops_mistakes(const Json& report);

}  // namespace vpr
