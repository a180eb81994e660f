// Pictures as PNG files.
#pragma once

#include <filesystem>

#include "base/output_file.h"

namespace cv {
class Mat;
}

namespace vpr {

/// Grey or BGR, 8 bits. The caller commits. Throws Error(output).
OutputFile write_png(const std::filesystem::path& path, const cv::Mat& image, Existing existing);

}  // namespace vpr
