#include "images/decode.h"

#include <limits>
#include <string_view>

#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "base/error.h"
#include "base/mapped_file.h"
#include "images/codec_scope.h"

namespace vpr {
namespace {

constexpr std::string_view kJpegStart = "\xff\xd8\xff";
constexpr std::string_view kJpegEnd = "\xff\xd9";
constexpr uint8_t kStartOfScan = 0xda;

// Where the compressed data of a JPEG begin: after the segments, whose previews hold end marks of
// their own. npos if the segments themselves are cut.
size_t jpeg_scan_start(std::string_view file) {
  size_t at = 2;
  while (at + 4 <= file.size()) {
    const auto byte = [&](size_t i) { return static_cast<uint8_t>(file[at + i]); };
    if (byte(0) != 0xff) return std::string_view::npos;
    if (byte(1) == 0xff) {  // fill byte
      ++at;
      continue;
    }
    if (byte(1) == kStartOfScan) return at;
    at += 2 + (size_t{byte(2)} << 8 | byte(3));
  }
  return std::string_view::npos;
}

bool is_truncated_jpeg(std::string_view file) {
  if (!file.starts_with(kJpegStart)) return false;
  const size_t scan = jpeg_scan_start(file);
  if (scan == std::string_view::npos) return true;
  const size_t end = file.rfind(kJpegEnd);
  return end == std::string_view::npos || end < scan;
}

// Beyond what check_frame_size may allow; OpenCV keeps to itself how large.
[[noreturn]] void fail_as_too_large(const std::filesystem::path& path) {
  throw Error(ErrorKind::usage,
              fmt::format("{}: has more than 2^30 pixels, or 2^20 a side, which OpenCV does not "
                          "decode; remove it, or make it smaller",
                          path.string()));
}

}  // namespace

cv::Mat decode_image(const std::filesystem::path& path, PixelFormat format) {
  const auto fail = [&](std::string_view why) {
    throw Error(ErrorKind::input,
                fmt::format("{}: can't be decoded: {}; remove it, or give --skip-unreadable",
                            path.string(), why));
  };
  const MappedFile file(path);
  if (file.text().empty()) fail("the file is empty");
  if (is_truncated_jpeg(file.text())) fail("the JPEG is truncated");
  if (file.text().size() > static_cast<size_t>(std::numeric_limits<int>::max()))
    fail("the file is larger than 2 GiB");
  const cv::Mat bytes(1, static_cast<int>(file.text().size()), CV_8U,
                      const_cast<char*>(file.text().data()));
  cv::Mat image;
  try {
    const CodecScope scope(path);
    image =
        cv::imdecode(bytes, format == PixelFormat::grey ? cv::IMREAD_GRAYSCALE : cv::IMREAD_COLOR);
  } catch (const cv::Exception& error) {
    if (error.err.find("CV_IO_MAX_IMAGE") != std::string::npos) fail_as_too_large(path);
    fail(error.err);
  }
  if (image.empty()) fail("it is damaged or not an image");
  return image;
}

}  // namespace vpr
