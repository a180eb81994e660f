#include "report/png_file.h"

#include <span>
#include <vector>

#include <opencv2/imgcodecs.hpp>

namespace vpr {

OutputFile write_png(const std::filesystem::path& path, const cv::Mat& image, Existing existing) {
  std::vector<uint8_t> png;
  cv::imencode(".png", image, png);
  OutputFile file(path, existing);
  file.write(std::as_bytes(std::span(png)));
  return file;
}

}  // namespace vpr
