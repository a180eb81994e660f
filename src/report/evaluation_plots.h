// The curves of an evaluation as plots for papers.
#pragma once

#include <filesystem>

#include "base/json_fwd.h"
#include "base/monitor.h"
#include "evaluation/judgement.h"

namespace vpr {

/// Writes precision-recall, recall@K (where ranks are known) and timeline as SVG and PNG, and the
/// matrix as PNG, into `folder`, which exists. Throws Error(output) if gnuplot fails.
void draw_evaluation(const Json& report, const Judgement& judgement, const GroundTruth& truth,
                     const ScoreMatrix* matrix, const std::filesystem::path& folder,
                     const Monitor& monitor);

}  // namespace vpr
