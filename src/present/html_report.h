// An evaluation as one HTML file that needs nothing else: numbers, curve, timeline, matrix and a
// gallery.
#pragma once

#include <string>

#include "base/json_fwd.h"
#include "base/monitor.h"
#include "evaluate/judgement.h"
#include "present/gallery.h"

namespace vpr {

/// The page, which opens with the sentence `summary`; without judgement where the ground truth is
/// not known. Its size does not grow with the number of queries but for a line of data each; of
/// `matrix` (which may be absent) only a small picture is kept. Throws as make_thumbnails and
/// ScoreMatrix::for_each_row do.
std::string html_report(const Json& report, const std::string& summary, const Judgement& judgement,
                        const GroundTruth& truth, const ScoreMatrix* matrix,
                        const FrameSources& sources, const Monitor& monitor);

}  // namespace vpr
