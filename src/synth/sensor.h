// What a phone's camera adds to a picture.
#pragma once

#include "base/random.h"

namespace cv {
class Mat;
}

namespace vpr {

inline constexpr double kShutterS = 1.0 / 50;  ///< where no other time is stated

/// Blurs by the way that the picture moves while the shutter is open, in pixels.
void blur_by_turning(cv::Mat& picture, double sideways, double upwards);

/// Adds normal noise of a standard deviation in grey values to every channel of every pixel.
void add_noise(cv::Mat& picture, double deviation, RandomEngine& engine);

}  // namespace vpr
