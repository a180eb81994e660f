#include "report/png_file.h"

#include <vector>

#include <opencv2/imgcodecs.hpp>

namespace vpr {

std::string png_of(const cv::Mat& image) {
  std::vector<uint8_t> png;
  // Level 9 is sixteen times slower than 6 for a seventh less.
  cv::imencode(".png", image, png, {cv::IMWRITE_PNG_COMPRESSION, 6});
  return {png.begin(), png.end()};
}

}  // namespace vpr
