#include "recordings/decode.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cerrno>
#include <cstdio>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <unistd.h>

#include "base/error.h"
#include "base/mapped_file.h"

namespace vpr {

namespace {

constexpr std::string_view kJpegStart = "\xff\xd8\xff";
constexpr size_t kMostScans = 100;  // usual progressive JPEGs have about 10

bool has(std::string_view file, size_t at, std::string_view bytes) {
  return file.size() > at && file.substr(at).starts_with(bytes);
}

// Checks the signature: OpenCV has more decoders, for formats that cameras do not write, and some
// of them crash on damaged files. It detects DICOM by bytes that may follow any other signature.
bool is_accepted_format(std::string_view file) {
  using namespace std::string_view_literals;
  if (has(file, 128, "DICM")) return false;
  for (const std::string_view start :
       {kJpegStart, "\x89PNG\r\n\x1a\n"sv, "II*\0"sv, "MM\0*"sv, "BM"sv})
    if (file.starts_with(start)) return true;
  const bool is_pnm = file.size() > 2 && file[0] == 'P' && "2356"sv.find(file[1]) != file.npos;
  return is_pnm || (file.starts_with("RIFF") && has(file, 8, "WEBPVP8"));
}

struct JpegScans {
  size_t count = 0;
  size_t first = std::string_view::npos;
};

// Skips segments by their length: their previews have their own markers.
JpegScans jpeg_scans(std::string_view file) {
  JpegScans scans;
  const auto byte = [&](size_t i) { return static_cast<uint8_t>(file[i]); };
  for (size_t at = file.find('\xff', 2); at < file.size() - 3; at = file.find('\xff', at)) {
    const uint8_t mark = byte(at + 1);
    const bool is_data = mark < 0xc0 || (mark >= 0xd0 && mark <= 0xd7);
    if (mark == 0xd9) break;
    if (mark == 0xda && scans.count++ == 0) scans.first = at;
    if (mark == 0xff)  // a fill byte
      ++at;
    else
      at += is_data ? 2 : 2 + (size_t{byte(at + 2)} << 8 | byte(at + 3));
  }
  return scans;
}

// OpenCV looks for an orientation only in the first segment APP1: removes others, such as XMP,
// before the one with EXIF.
void put_exif_first(std::string& jpeg) {
  constexpr std::string_view kApp1("\xff\xe1", 2);
  constexpr size_t kHead = 4;  // marker and length
  constexpr std::string_view kExif("Exif\0\0", 6);
  std::vector<std::pair<size_t, size_t>> others;  // begin and size
  for (size_t at = 2; at + kHead <= jpeg.size() && jpeg[at] == '\xff' && jpeg[at + 1] != '\xda';) {
    const size_t size =
        2 + (size_t{static_cast<uint8_t>(jpeg[at + 2])} << 8 | static_cast<uint8_t>(jpeg[at + 3]));
    if (jpeg.compare(at, kApp1.size(), kApp1) == 0) {
      if (jpeg.compare(at + kHead, kExif.size(), kExif) == 0) {
        for (auto other = others.rbegin(); other != others.rend(); ++other)
          jpeg.erase(other->first, other->second);
        return;
      }
      others.emplace_back(at, size);
    }
    at += size;
  }
}

constexpr uint64_t kMillion = 1'000'000;

std::atomic<uint64_t> most_megapixels{kDefaultMegapixels};

// The file that this thread decodes; null outside a CodecScope. Neither OpenCV's allocators nor
// streams identify their callers.
thread_local const std::filesystem::path* decoded_file = nullptr;

/// OpenCV's own allocator with a size limit for images. It must replace the allocator of all
/// matrices, because OpenCV falls back to that one if a matrix's own allocator refuses.
class LimitedAllocator : public cv::MatAllocator {
 public:
  cv::UMatData* allocate(int dims, const int* sizes, int type, void* data, size_t* step,
                         cv::AccessFlag access, cv::UMatUsageFlags usage) const override {
    if (decoded_file != nullptr && dims == 2)
      check_frame_size(*decoded_file, static_cast<uint64_t>(sizes[1]),
                       static_cast<uint64_t>(sizes[0]));
    return usual().allocate(dims, sizes, type, data, step, access, usage);
  }
  bool allocate(cv::UMatData* data, cv::AccessFlag access,
                cv::UMatUsageFlags usage) const override {
    return usual().allocate(data, access, usage);
  }
  void deallocate(cv::UMatData* data) const override { usual().deallocate(data); }

 private:
  static const cv::MatAllocator& usual() { return *cv::Mat::getStdAllocator(); }
};

// Before main(), because OpenCV does not protect the change against other threads.
[[maybe_unused]] const bool kIsInstalled = [] {
  static LimitedAllocator allocator;
  cv::Mat::setDefaultAllocator(&allocator);
  return true;
}();

// Receives the output of the stream of mute_codecs().
ssize_t pass_on(void*, const char* bytes, size_t size) {
  if (decoded_file != nullptr) return static_cast<ssize_t>(size);
  size_t done = 0;
  while (done < size) {
    const ssize_t written = ::write(STDERR_FILENO, bytes + done, size - done);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) break;
    done += static_cast<size_t>(written);
  }
  return static_cast<ssize_t>(done);
}

// As OpenCV scales PGM and PPM files that are text.
void scale_to_white(cv::Mat& image, int largest) {
  cv::Mat table(1, 256, CV_8U);
  for (int value = 0; value < 256; ++value)
    table.at<uint8_t>(value) = static_cast<uint8_t>(std::min(value * 255 / largest, 255));
  cv::LUT(image, table, image);
}

// OpenCV multiplies colors of 8 bits by alpha.
void refuse_transparent(const std::filesystem::path& path, const cv::Mat& bytes) {
  const cv::Mat image = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
  cv::Mat alpha;
  if (image.channels() == 4) cv::extractChannel(image, alpha, 3);
  if (alpha.empty() || range_of(alpha).low < 255)
    throw Error(ErrorKind::input,
                "{}: has transparent pixels, which are not supported. Save it without its alpha "
                "channel, or as PNG",
                path.string());
}

// With 16 bits per channel if the file has them.
cv::Mat decode_pixels(const std::filesystem::path& path, PixelFormat format) {
  const auto fail = [&](std::string_view why) {
    throw Error(ErrorKind::input, "{}: can't be decoded: {}. Remove it, or use --skip-unreadable",
                path.string(), why);
  };
  std::string file = read_whole_file(path);
  if (file.empty()) fail("the file is empty");
  if (!is_accepted_format(file))
    fail(fmt::format("it is not a JPEG, PNG, TIFF, BMP, PPM, PGM or WebP image{}",
                     file.starts_with("II+") ? ", but a BigTIFF" : ""));
  if (file.starts_with(kJpegStart)) {
    const JpegScans scans = jpeg_scans(file);
    if (scans.count > kMostScans)
      fail(fmt::format("the JPEG has {} scans, more than {}", scans.count, kMostScans));
    const size_t end = file.rfind("\xff\xd9");
    if (scans.count == 0 || end == std::string::npos || end < scans.first)
      fail("the JPEG is truncated");
    put_exif_first(file);
  }
  const ImageHeader header = read_image_header(file);
  check_frame_size(path, header.tile_width, header.tile_height);
  if (!header.unread.empty())
    throw Error(ErrorKind::input,
                "{}: has {} pixels, which are not supported. Convert them to unsigned integers of "
                "8 or 16 bits, with 0 for black",
                path.string(), header.unread);
  if (header.has_pages)
    throw Error(
        ErrorKind::input,
        "{}: has several pages, but an image is one frame. Split it, as in {} {} page-%05d.png",
        path.string(), file.starts_with("\x89PNG") ? "ffmpeg -i" : "convert",
        path.filename().string());
  if (file.size() > static_cast<size_t>(std::numeric_limits<int>::max()))
    fail("the file is larger than 2 GiB");
  const cv::Mat bytes(1, static_cast<int>(file.size()), CV_8U, const_cast<char*>(file.data()));
  cv::Mat image;
  try {
    const CodecScope scope(path);
    const int depth = header.is_16_bit ? cv::IMREAD_ANYDEPTH : 0;
    // A gray image stays gray. Only libjpeg reads gray directly: libpng converts to linear light
    // first if the file states its gamma.
    const int gray = file.starts_with(kJpegStart) ? cv::IMREAD_GRAYSCALE : cv::IMREAD_ANYCOLOR;
    image = cv::imdecode(bytes, depth | (format == PixelFormat::gray ? gray : cv::IMREAD_COLOR));
    if (header.has_alpha && image.depth() == CV_8U) refuse_transparent(path, bytes);
  } catch (const cv::Exception& error) {
    // Larger than any limit of check_frame_size; OpenCV does not report the size.
    if (error.err.find("CV_IO_MAX_IMAGE") != std::string::npos)
      throw Error(ErrorKind::usage,
                  "{}: has more than 2^30 pixels, or 2^20 per side, which OpenCV does not decode. "
                  "Remove it, or make it smaller",
                  path.string());
    fail(error.err);
  }
  if (image.empty() || (image.depth() != CV_8U && image.depth() != CV_16U))
    fail(fmt::format("it is damaged, or of a kind that OpenCV does not read{}{}",
                     header.kind.empty() ? "" : ": ", header.kind));
  if (header.largest < 255) scale_to_white(image, header.largest);
  turn_upright(image, header.orientation);
  return in_format(image, format);
}

}  // namespace

cv::Mat in_format(const cv::Mat& image, PixelFormat format) {
  if (image.channels() == (format == PixelFormat::gray ? 1 : 3)) return image;
  cv::Mat converted;
  cv::cvtColor(image, converted,
               format == PixelFormat::gray ? cv::COLOR_BGR2GRAY : cv::COLOR_GRAY2BGR);
  return converted;
}

PixelRange range_of(const cv::Mat& image) {
  PixelRange range;
  cv::minMaxIdx(image.reshape(1), &range.low, &range.high);
  return range;
}

std::optional<PixelRange> united(const std::optional<PixelRange>& a,
                                 const std::optional<PixelRange>& b) {
  if (!a || !b) return a ? a : b;
  return PixelRange{std::min(a->low, b->low), std::max(a->high, b->high)};
}

void scale_to_8_bits(cv::Mat& image, const std::optional<PixelRange>& range) {
  if (image.depth() != CV_16U) return;
  const auto [low, high] = range ? *range : range_of(image);
  const double scale = 255 / std::max(1.0, high - low);
  image.convertTo(image, CV_8U, scale, -scale * low);
}

void turn_upright(cv::Mat& image, int orientation) {
  if (orientation >= 5) cv::transpose(image, image);
  const bool flips_x = orientation == 2 || orientation == 3 || orientation == 6 || orientation == 7;
  const bool flips_y = orientation == 3 || orientation == 4 || orientation == 7 || orientation == 8;
  if (flips_x) cv::flip(image, image, 1);
  if (flips_y) cv::flip(image, image, 0);
}

cv::Mat decode_image(const std::filesystem::path& path, PixelFormat format,
                     const std::optional<PixelRange>& range) {
  cv::Mat image = decode_pixels(path, format);
  scale_to_8_bits(image, range);
  return image;
}

std::optional<PixelRange> pixel_range(const std::filesystem::path& path) {
  if (!read_image_header(read_whole_file(path)).is_16_bit) return std::nullopt;
  return range_of(decode_pixels(path, PixelFormat::gray));
}

uint64_t set_megapixel_limit(uint64_t megapixels) {
  require_range("max_megapixels", static_cast<double>(megapixels), 1, kMaxMegapixels);
  return most_megapixels.exchange(megapixels);
}

void check_frame_size(const std::filesystem::path& file, uint64_t width, uint64_t height) {
  const uint64_t limit = most_megapixels;
  if (width == 0 || height <= limit * kMillion / width) return;
  const uint64_t needed = (width * height + kMillion - 1) / kMillion;
  throw Error(ErrorKind::usage,
              "{}: has {} x {} pixels, more than the limit of {} megapixels. Remove it, or {}",
              file.string(), width, height, limit,
              needed > kMaxMegapixels
                  ? "make it smaller"
                  : fmt::format("pass --max-megapixels {} to accept it", needed));
}

CodecScope::CodecScope(const std::filesystem::path& file) {
  assert(decoded_file == nullptr);
  decoded_file = &file;
}

CodecScope::~CodecScope() { decoded_file = nullptr; }

// glibc allows a program to set the stream.
void mute_codecs() {
  std::FILE* const stream = ::fopencookie(nullptr, "w", {nullptr, pass_on, nullptr, nullptr});
  if (stream == nullptr) return;
  std::setvbuf(stream, nullptr, _IONBF, 0);
  stderr = stream;
}

}  // namespace vpr
