// HTML files without external references: an evaluation with charts, a gallery and tables, and
// questions to a person whether images show the same place.
#pragma once

#include <string>

#include "base/monitor.h"
#include "evaluate/report.h"
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

/// One question per place, with images of its first recognition, its representative and its last
/// recognition: at the anchors of both windows. The page saves answers as read_place_answers reads
/// them, and begins with those by which `evaluation` was judged. Throws as require_places and
/// make_thumbnails do.
std::string place_questions_page(const Evaluation& evaluation, const Report& report,
                                 const FrameSources& sources, const Monitor& monitor);

/// Questions about the best matches of at most kMostFrames query frames: first some that are spread
/// evenly along the path, then those that are nearest to the decision. The page saves labels as
/// read_labels reads them. Frames that `evaluation` was judged by are not asked again. Throws as
/// make_thumbnails does, and Error(usage) for places of FAB-MAP, which have no images.
std::string frame_questions_page(const Evaluation& evaluation, const Report& report,
                                 const FrameSources& sources, const Monitor& monitor);

/// Asks which of some evenly spaced training frames are places of FAB-MAP, and which query frame
/// shows them. The page saves them as read_marked_places reads them. Best matches suggest the query
/// frames. Throws as frame_questions_page does.
std::string fabmap_questions_page(const Evaluation& evaluation, const Report& report,
                                  const FrameSources& sources, const Monitor& monitor);

}  // namespace vpr
