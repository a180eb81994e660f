// Why a frame was taken for a place of FAB-MAP: as JSON ("explanation" of a result), for people,
// and drawn.
#pragma once

#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "pipeline/fabmap_explain.h"
#include "report/word_picture.h"

namespace vpr {

Json explanation_json(const Explanation& explanation);
std::string explanation_text(const Explanation& explanation);

/// The words of a frame that speak for and against the place, marked where they are.
MarkedImage mark_words(const FrameFeatures& features, const PlaceExplanation& place,
                       const std::string& title);

}  // namespace vpr
