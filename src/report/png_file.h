// Pictures as PNG files.
#pragma once

#include <string>

namespace cv {
class Mat;
}

namespace vpr {

/// The bytes of a PNG file. `image`: grey or BGR, 8 bits.
std::string png_of(const cv::Mat& image);

}  // namespace vpr
