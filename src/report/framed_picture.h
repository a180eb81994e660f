// A matrix's picture with axes that count frames, a legend and the scale of its greys.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "report/frame_axis.h"
#include "report/palette.h"

namespace cv {
class Mat;
}

namespace vpr {

struct PictureFrame {
  std::vector<FrameBand> columns;
  std::vector<FrameBand> rows;
  double pixels = 1;  ///< of the picture for a row, and for a column
  std::vector<Meaning> shown = {};
  std::optional<std::pair<double, double>> greys = {};  ///< the values of black and of white
  std::string grey_words = {};
};

/// `image` (BGR) on white, with margins.
cv::Mat framed(const cv::Mat& image, const PictureFrame& frame);

}  // namespace vpr
