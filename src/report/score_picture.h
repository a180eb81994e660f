// Scores, ground truth and recognitions as one picture.
#pragma once

#include "base/monitor.h"
#include "evaluation/judgement.h"

namespace cv {
class Mat;
}

namespace vpr {

/// BGR, at most `most_pixels` a side: query windows from top to bottom, columns of the layout from
/// left to right, sequences divided by lines. Dark is a good score (the best of those that fall
/// into a pixel; the outer 1 % on both sides are cut off), white where there is none or no matrix.
/// Ground truth is green; recognised cells are blue if correct, red if not, grey-blue if ignored,
/// and cover it. An empty layout gives one white pixel.
cv::Mat draw_scores(const Judgement& judgement, const GroundTruth& truth, const ScoreMatrix* matrix,
                    size_t most_pixels, const Monitor& monitor);

}  // namespace vpr
