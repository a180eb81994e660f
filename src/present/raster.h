// Pictures as PNG files.
#pragma once

#include <string>

namespace cv {
class Mat;
}

namespace vpr {

/// The bytes of a PNG file. `image`: gray or BGR, 8 bits.
std::string png_of(const cv::Mat& image);

/// The bytes of a PNG file that shows a whole SVG file (by librsvg) on white, with `zoom` pixels
/// per unit. Images in the SVG are data: no other file is opened. Throws Error(internal) if the
/// text is not an SVG, or too large to draw.
std::string png_of_svg(const std::string& svg, double zoom);

}  // namespace vpr
