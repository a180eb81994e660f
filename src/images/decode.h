// One image file to pixels.
#pragma once

#include <filesystem>

namespace cv {
class Mat;
}

namespace vpr {

/// What a frame is decoded to: 8 bits, one channel, or blue, green and red.
enum class PixelFormat { grey, bgr };

/// 8 bits a channel, as OpenCV's IMREAD_GRAYSCALE or IMREAD_COLOR decodes, EXIF orientation
/// applied. Throws Error(input), naming the file, when it is missing, empty, damaged, or not a
/// JPEG, PNG, TIFF, BMP, PPM, PGM or WebP image by its first bytes, and for a JPEG that is
/// truncated (OpenCV itself fills the missing part with gray) or has more than 100 scans;
/// Error(usage) when it is larger than the MegapixelLimit, before memory is allocated for its
/// pixels.
cv::Mat decode_image(const std::filesystem::path& path, PixelFormat format);

}  // namespace vpr
