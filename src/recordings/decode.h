// Decoding of a single image file, limits of the codecs, and fields of headers that OpenCV does not
// check or apply.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace cv {
class Mat;
}

namespace vpr {

/// The format of decoded frames: 8 bits, one channel; or blue, green and red.
enum class PixelFormat { gray, bgr };

/// The 16-bit values that become 0 and 255.
struct PixelRange {
  double low = 0;
  double high = 65535;
};

/// 8 bits per channel, with EXIF orientation applied. Gray values of a color JPEG are its luma, as
/// libjpeg decodes it; those of other color images are computed from their red, green and blue by
/// BGR2GRAY, whatever gamma and color space the file states. 16-bit values are scaled by `range`
/// or, without one, by the range of the image. Throws Error(input), with the file, if it is
/// missing, empty, damaged, or not a JPEG, PNG, TIFF, BMP, PPM, PGM or WebP image by its first
/// bytes, and for a JPEG that is truncated (OpenCV itself fills the missing part with gray) or has
/// more than 100 scans; Error(usage) if it is larger than the limit of megapixels, before memory is
/// allocated for its pixels.
cv::Mat decode_image(const std::filesystem::path& path, PixelFormat format,
                     const std::optional<PixelRange>& range = {});

/// The range of the gray values of a 16-bit image; nullopt for other images. Throws as decode_image
/// does.
std::optional<PixelRange> pixel_range(const std::filesystem::path& path);

/// An image of gray or of blue, green and red, converted by BGR2GRAY or GRAY2BGR if necessary; may
/// share the pixels of `image`.
cv::Mat in_format(const cv::Mat& image, PixelFormat format);

/// The least and the largest value of all channels.
PixelRange range_of(const cv::Mat& image);

/// The range of both.
std::optional<PixelRange> united(const std::optional<PixelRange>& a,
                                 const std::optional<PixelRange>& b);

/// Scales 16-bit values as decode_image does; images of 8 bits do not change.
void scale_to_8_bits(cv::Mat& image, const std::optional<PixelRange>& range);

/// Applies an EXIF orientation, 1 to 8; 1: as stored.
void turn_upright(cv::Mat& image, int orientation);

/// The default limit of a frame.
constexpr uint64_t kDefaultMegapixels = 100;
/// OpenCV cannot decode more than 2^30 pixels.
constexpr uint64_t kMaxMegapixels = 1073;

/// Limits the size of decoded frames in the whole process, in millions of pixels; returns the last
/// limit. Throws Error(usage) for a number outside 1 to kMaxMegapixels.
uint64_t set_megapixel_limit(uint64_t megapixels);

/// Checks a frame before it is decoded. Throws Error(usage), with the file, for a frame above the
/// limit.
void check_frame_size(const std::filesystem::path& file, uint64_t width, uint64_t height);

/// Surrounds calls of image libraries that decode `file`, in one thread. OpenCV allocates the
/// memory of an image after it has read the header, for any format: an image that check_frame_size
/// refuses is refused then, before anything is allocated or decoded.
class CodecScope {
 public:
  explicit CodecScope(const std::filesystem::path& file);
  ~CodecScope();
  CodecScope(const CodecScope&) = delete;
  CodecScope& operator=(const CodecScope&) = delete;
};

/// From now on, drops the output of libraries to C's standard error within a CodecScope, as libpng
/// and libjpeg write it; other output is not affected. Call it before threads start.
void mute_codecs();

struct ImageHeader {
  uint64_t tile_width = 0;  ///< TIFF: of the tiles that are allocated whole; 0: none
  uint64_t tile_height = 0;
  std::string unread;      ///< TIFF: the kind of pixels, such as "signed", that are not supported
  std::string kind;        ///< TIFF: its pixels, for a message; empty: other formats
  bool has_pages = false;  ///< more than one image; a TIFF's copies in other sizes do not count
  bool has_alpha = false;  ///< TIFF: its colors are not multiplied by alpha
  bool is_16_bit = false;  ///< PNG, TIFF, PGM and PPM: 16 bits per channel
  int largest = 255;       ///< binary PGM and PPM of 8 bits: the value of white
  /// WebP: EXIF orientation 1 to 8, which OpenCV applies to other formats. 1: as stored.
  int orientation = 1;
};

/// Never throws: fields that a damaged header lacks keep their defaults.
ImageHeader read_image_header(std::string_view file);

}  // namespace vpr
