// Fields in the headers of images and videos that OpenCV does not check or apply.
#pragma once

#include <cstdint>
#include <string_view>

namespace vpr {

struct ImageHeader {
  uint64_t tile_width = 0;  ///< TIFF: of the tiles that are allocated whole; 0: none
  uint64_t tile_height = 0;
  bool is_float = false;    ///< TIFF: floating-point pixels
  bool is_gray_16 = false;  ///< PNG, TIFF and PGM: one channel of 16 bits
  /// WebP: EXIF orientation 1 to 8, which OpenCV applies to other formats. 1: as stored.
  int orientation = 1;
};

/// Never throws: fields that a damaged header lacks keep their defaults.
ImageHeader read_image_header(std::string_view file);

/// The clockwise rotation, 0, 90, 180 or 270 degrees, that shows the frames of a video upright: of
/// the first video track of an MP4 or QuickTime file. -1 for other files.
int video_rotation(std::string_view file);

}  // namespace vpr
