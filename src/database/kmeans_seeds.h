// Where k-means starts.
#pragma once

#include "base/monitor.h"
#include "base/random.h"

namespace cv {
class Mat;
}

namespace vpr {

/// `count` rows of `points` (CV_32F, or CV_8U strings of bits) to start from: by k-means++ (Arthur
/// & Vassilvitskii 2007), or by k-means|| (Bahmani et al. 2012) where points x count is large.
/// count <= rows. Depends on the points and the engine alone.
cv::Mat choose_seeds(const cv::Mat& points, size_t count, RandomEngine& engine,
                     const Monitor& monitor);

}  // namespace vpr
