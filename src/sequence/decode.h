// Decoding of one image file, and limits on what codecs may do.
#pragma once

#include <cstdint>
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

/// What a frame may have where nothing else is said.
constexpr uint64_t kUsualMegapixels = 100;
/// OpenCV decodes nothing larger than 2^30 pixels.
constexpr uint64_t kMostMegapixels = 1073;

/// The largest frame, in millions of pixels, that the whole process decodes while it lives.
class MegapixelLimit {
 public:
  /// Throws Error(usage) for a number that is not from 1 to kMostMegapixels.
  explicit MegapixelLimit(uint64_t megapixels);
  ~MegapixelLimit();
  MegapixelLimit(const MegapixelLimit&) = delete;
  MegapixelLimit& operator=(const MegapixelLimit&) = delete;

 private:
  uint64_t before_;
};

/// Checks a frame before it is decoded. Throws Error(usage), naming the file, for a frame of more
/// pixels than are allowed.
void check_frame_size(const std::filesystem::path& file, uint64_t width, uint64_t height);

/// Surrounds calls of image libraries that decode `file`, in one thread. OpenCV asks for the memory
/// of a picture when it has read its header, whatever the format: what check_frame_size refuses is
/// refused then, and nothing has been allocated or decoded.
class CodecScope {
 public:
  explicit CodecScope(const std::filesystem::path& file);
  ~CodecScope();
  CodecScope(const CodecScope&) = delete;
  CodecScope& operator=(const CodecScope&) = delete;
};

/// Drops from now on what libraries print to C's standard error within a CodecScope, as libpng and
/// libjpeg do; whatever else goes there is not touched. Call it before threads start.
void mute_codecs();

}  // namespace vpr
