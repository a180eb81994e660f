// Loop closures against a trajectory: as JSON (vpr.loops/1), tables, charts and a page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "evaluate/loops.h"
#include "present/chart.h"
#include "present/run_info.h"
#include "present/table.h"

namespace vpr {

/// Everything that was judged, with what it was called and judged by.
struct LoopsEvaluation {
  std::string name;
  LoopList list;
  Trajectory trajectory;
  LoopRules rules;
  LoopJudgment judgment;
};

/// Everything of a report but "machine" and "timing".
Json loops_json(const LoopsEvaluation& evaluation, const RunInfo& run);

/// "17 of 20 revisits are found, and 3 of 190 loops are wrong."
std::string loops_sentence(const LoopsEvaluation& evaluation);

/// One row: loops, frames and revisits, and with scores the metrics of the curve.
Table loops_table(const LoopsEvaluation& evaluation);

/// The revisits that nobody found and the loops that are wrong, the first 20 of each; empty where
/// there are none.
std::string loops_mistakes(const LoopsEvaluation& evaluation);

/// The trajectory seen along its shortest extent, as a plan: a line from frame to frame for every
/// right and every wrong loop, and dots at the frames that have one, listed or not.
Chart loops_map_chart(const LoopsEvaluation& evaluation);

/// Writes loops and, with scores, precision-recall as SVG and PNG into the folder of an output.
/// Throws Error(output).
void draw_loops(const LoopsEvaluation& evaluation, const std::filesystem::path& folder);

/// The page: a sentence, the table, the trajectory with what is right, wrong and missing, the curve
/// where the list has scores, and the first wrong loops.
std::string loops_page(const LoopsEvaluation& evaluation, const RunInfo& run);

}  // namespace vpr
