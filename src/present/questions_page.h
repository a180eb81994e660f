// The page that asks a person about each place of a result, as HTML.
#pragma once

#include <string>

#include "base/monitor.h"
#include "evaluate/evaluation.h"
#include "files/report.h"
#include "present/gallery.h"

namespace vpr {

/// One question per place, with images of its first recognition, its representative and its last
/// recognition: at the anchors of both windows. The page saves answers as read_place_answers reads
/// them, and begins with those by which `evaluation` was judged. Throws as require_places and
/// make_thumbnails do.
std::string questions_page(const Evaluation& evaluation, const Report& report,
                           const FrameSources& sources, const Monitor& monitor);

}  // namespace vpr
