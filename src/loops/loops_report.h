// Loop closures evaluated by a trajectory: as JSON (vpr.loops/3), tables, charts and a page.
#pragma once

#include <filesystem>
#include <string>

#include "base/json_fwd.h"
#include "loops/loops.h"
#include "present/chart.h"
#include "present/table.h"
#include "query/run_info.h"

namespace vpr {

struct LoopsEvaluation {
  std::string name;
  LoopList list;
  Trajectory trajectory;
  LoopRules rules;
  LoopJudgment judgment;
};

/// The report without "machine" and "timing", and the schema of the whole file.
Json loops_json(const LoopsEvaluation& evaluation, const RunInfo& run);
Json loops_schema();

/// The sentence, the mean values and the first mistakes in at most 12 lines of 80 columns.
std::string loops_text(const LoopsEvaluation& evaluation);

/// One row: counts of loops, frames and revisits and, if there are scores, metrics of the curve.
Table loops_table(const LoopsEvaluation& evaluation);

/// The first `most` incorrect loops and the first `most` revisits without a correct loop; may be
/// empty.
std::string loops_mistakes(const LoopsEvaluation& evaluation, size_t most = 20);

/// The trajectory without its shortest extent, with a line per correct and incorrect loop, and the
/// frames that have a loop.
Chart loops_map_chart(const LoopsEvaluation& evaluation);

/// Writes loops and, if there are scores, precision-recall as SVG, PDF and PNG into the folder of
/// an output. Throws Error(output).
void draw_loops(const LoopsEvaluation& evaluation, const std::filesystem::path& folder);

std::string loops_page(const LoopsEvaluation& evaluation, const RunInfo& run);

}  // namespace vpr
