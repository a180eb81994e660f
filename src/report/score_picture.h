// Scores, ground truth and recognitions as one picture.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "base/monitor.h"
#include "evaluation/judgement.h"
#include "report/palette.h"

namespace vpr {

struct ScorePicture {
  cv::Mat image;                                   ///< BGR
  size_t cells = 1;                                ///< rows, and columns, in a pixel
  std::optional<std::pair<double, double>> greys;  ///< the scores of black and of white
  std::vector<Meaning> shown;                      ///< colours that occur, for a legend
};

/// At most `most_pixels` a side: query windows from top to bottom, columns of the layout from left
/// to right, sequences divided by lines. Dark is a good score (the best of those that fall into a
/// pixel; the outer 1 % on both sides are cut off), white where there is none or no matrix. Ground
/// truth and recognised cells have the palette's colours; the latter cover the former. An empty
/// layout gives one white pixel.
ScorePicture draw_scores(const Judgement& judgement, const GroundTruth& truth,
                         const ScoreMatrix* matrix, size_t most_pixels, const Monitor& monitor);

}  // namespace vpr
