#include "report/png_file.h"

#include <vector>

#include <opencv2/imgcodecs.hpp>

namespace vpr {

std::string png_of(const cv::Mat& image) {
  std::vector<uint8_t> png;
  cv::imencode(".png", image, png, {cv::IMWRITE_PNG_COMPRESSION, 9});
  return {png.begin(), png.end()};
}

}  // namespace vpr
