// The curves of an evaluation as plots for papers.
#pragma once

#include <filesystem>

#include "base/json_fwd.h"
#include "base/monitor.h"
#include "evaluation/judgement.h"
#include "report/plot.h"

namespace vpr {

/// Best matches and ground truth along the query's path; no lines where there are neither.
Plot timeline_plot(const Json& report, const Judgement& judgement, const GroundTruth& truth,
                   const Monitor& monitor = {});

/// What draw_scores draws, with axes, a legend and, of a matrix, the scale of its greys.
Plot matrix_plot(const Json& report, const Judgement& judgement, const GroundTruth& truth,
                 const ScoreMatrix* matrix, const Monitor& monitor);

/// Writes precision-recall, recall@K (where ranks are known), timeline and matrix as SVG and PNG
/// into `folder`, which exists. Throws Error(output) if gnuplot fails.
void draw_evaluation(const Json& report, const Judgement& judgement, const GroundTruth& truth,
                     const ScoreMatrix* matrix, const std::filesystem::path& folder,
                     const Monitor& monitor);

}  // namespace vpr
