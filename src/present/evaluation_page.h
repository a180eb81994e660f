// An evaluation as one HTML file without external references: charts, a gallery and tables.
#pragma once

#include <string>

#include "base/monitor.h"
#include "files/report.h"
#include "present/gallery.h"

namespace vpr {

/// `summary`: the first sentence of the page. Without ground truth, the page shows matches without
/// evaluation. Its size grows by one line of data per query only. Throws as make_thumbnails and
/// ScoreMatrix::for_each_row do.
std::string evaluation_page(const Evaluation& evaluation, const Report& report, const RunInfo& run,
                            const std::string& summary, const FrameSources& sources,
                            const Monitor& monitor);

/// A page with `summary`, the path and ten images: the query frames and best matches of five cards.
std::string evaluation_preview(const Evaluation& evaluation, const Report& report,
                               const std::string& summary, const FrameSources& sources,
                               const Monitor& monitor);

}  // namespace vpr
