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
/// applied. Throws Error(input), naming the file, when it is missing, empty, not an image, or
/// truncated (OpenCV itself fills the missing part of a JPEG with grey); Error(usage) when it is
/// larger than the MegapixelLimit, before any memory is taken for its pixels.
cv::Mat decode_image(const std::filesystem::path& path, PixelFormat format);

}  // namespace vpr
