// Loop closures against a trajectory as one HTML file that needs nothing else.
#pragma once

#include <string>

#include "base/json_fwd.h"
#include "report/loops_report.h"

namespace vpr {

/// The page: a sentence, the table, the trajectory with what is right, wrong and missing, the curve
/// where the list has scores, and the first wrong loops. `report`: of the evaluation.
std::string loops_page(const LoopsEvaluation& evaluation, const Json& report);

}  // namespace vpr
