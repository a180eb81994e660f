// Charts as SVG text for an HTML report; colours are classes of its style sheet.
#pragma once

#include <string>

#include "evaluation/judgement.h"

namespace vpr {

/// Where a timeline's frames lie, for scripts.
struct TimelineFrame {
  double width = 1000;  ///< of the whole picture
  double left = 60;
  double plot_width = 930;
};

/// Precision against recall, best matches and, where there are some, all pairs.
std::string curve_svg(const Judgement& judgement);

/// Query frames from left to right; the column of each best match, of the ground truth, and below,
/// a bar of fixes. Bounded in size for any number of queries: marks that fall together are one.
std::string timeline_svg(const Judgement& judgement, const GroundTruth& truth,
                         const TimelineFrame& frame);

}  // namespace vpr
