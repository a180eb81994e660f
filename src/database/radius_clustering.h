// A vocabulary by OpenFABMAP's sequential clustering: words no nearer than a radius.
#pragma once

#include "base/monitor.h"

namespace cv {
class Mat;
}

namespace vpr {

/// Every row of `descriptors` (CV_32F or CV_8U) that is farther than `radius` from all centres so
/// far becomes one; then each row is assigned to its nearest centre (ties to the lower one), and
/// centres move to their members once. The distance of floats is Euclidean, of bits Hamming.
/// Depends on the order of rows. Throws Error(usage) if there is no descriptor, the radius is not
/// above 0, or there are more than `most_words` centres.
cv::Mat radius_words(const cv::Mat& descriptors, double radius, size_t most_words,
                     const Monitor& monitor);

}  // namespace vpr
