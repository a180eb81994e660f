#include "report/png_file.h"

#include <span>
#include <vector>

#include <opencv2/imgcodecs.hpp>

namespace vpr {

void write_png(OutputFile& file, const cv::Mat& image) {
  std::vector<uint8_t> png;
  cv::imencode(".png", image, png);
  file.write(std::as_bytes(std::span(png)));
}

}  // namespace vpr
