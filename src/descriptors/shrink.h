// Smaller pictures by exact means of areas.
#pragma once

namespace cv {
class Mat;
}

namespace vpr {

/// `grey`: 8 bits, one channel, at least 1x1. Every pixel of the picture that is returned is the
/// mean of the area that it covers, parts of pixels by their share, rounded to the nearest, a half
/// up: whole numbers only, the same on every machine. A smaller picture is enlarged by the same
/// rule.
cv::Mat shrink(const cv::Mat& grey, int width, int height);

}  // namespace vpr
