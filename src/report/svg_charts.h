// Charts as SVG text for an HTML report; colours are the palette's classes.
#pragma once

#include <string>

#include "base/monitor.h"
#include "evaluation/judgement.h"

namespace vpr {

struct ScorePicture;

/// Where a timeline's frames lie, for scripts.
struct TimelineFrame {
  double width = 1000;  ///< of the whole picture
  double left = 60;
  double plot_width = 930;
};

/// Precision against recall, best matches and, where there are some, all pairs.
std::string curve_svg(const Judgement& judgement);

/// How a chart shows scores: divided, and called so.
struct ScoreAxis {
  std::string label;
  double divisor = 1;
};

/// Best matches that a threshold accepts, from the strictest to the loosest: right ones, wrong
/// ones, and those that are not judged.
std::string threshold_svg(const Judgement& judgement, const ScoreAxis& axis);

/// Query frames from left to right, frames of the training sequences upwards, band by band: each
/// best match, the ground truth, and below, a bar of fixes. Bounded in size for any number of
/// queries: marks that fall together are one. `reference_word`: what the bands hold.
std::string timeline_svg(const Judgement& judgement, const GroundTruth& truth,
                         const std::string& reference_word, const TimelineFrame& frame,
                         const Monitor& monitor);

/// The picture with axes that count frames and, of a matrix, the scale of its greys. `png`: its
/// pixels as base64.
std::string matrix_svg(const Judgement& judgement, const ScorePicture& picture,
                       const std::string& png, const std::string& reference_word,
                       const std::string& score_words);

}  // namespace vpr
