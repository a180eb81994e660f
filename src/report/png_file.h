// Pictures as PNG files.
#pragma once

#include <filesystem>

#include "base/output_file.h"

namespace cv {
class Mat;
}

namespace vpr {

/// Grey or BGR, 8 bits. The caller commits. Throws Error(output).
void write_png(OutputFile& file, const cv::Mat& image);

}  // namespace vpr
