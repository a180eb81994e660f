// The charts of loop closures: the curve, and the trajectory with what is found, missed and wrong.
#pragma once

#include <filesystem>
#include <string>

#include "report/chart.h"
#include "report/loops_report.h"

namespace vpr {

/// Precision against recall of every frame's best loop. No series where the list has no scores.
Chart loops_curve_chart(const LoopsEvaluation& evaluation);

/// The trajectory seen along its shortest extent, as a plan: a line from frame to frame for every
/// right and every wrong loop, and dots at the frames that have one, listed or not.
Chart loops_map_chart(const LoopsEvaluation& evaluation);

/// Writes loops and, with scores, precision-recall as SVG and PNG into the folder of an output.
/// Throws Error(output).
void draw_loops(const LoopsEvaluation& evaluation, const std::filesystem::path& folder);

}  // namespace vpr
