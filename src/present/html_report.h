// An evaluation as one HTML file that needs nothing else: numbers, curve, timeline, matrix and a
// gallery.
#pragma once

#include <string>

#include "base/monitor.h"
#include "present/evaluation_report.h"
#include "present/gallery.h"

namespace vpr {

/// The page, which opens with the sentence `summary`; without judgment where the ground truth is
/// not known. Its size does not grow with the number of queries but for a line of data each; of
/// a matrix only a small picture is kept. Throws as make_thumbnails and ScoreMatrix::for_each_row
/// do.
std::string html_report(const Evaluation& evaluation, const Report& report, const RunInfo& run,
                        const std::string& summary, const FrameSources& sources,
                        const Monitor& monitor);

}  // namespace vpr
