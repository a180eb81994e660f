#include "images/codec_scope.h"

#include <atomic>
#include <cassert>
#include <cerrno>
#include <cstdio>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>
#include <unistd.h>

#include "base/error.h"

namespace vpr {
namespace {

constexpr uint64_t kMillion = 1'000'000;

std::atomic<uint64_t> most_megapixels{kUsualMegapixels};

// What is decoded in this thread; null outside a CodecScope. Neither OpenCV's allocators nor
// streams tell who calls them.
thread_local const std::filesystem::path* decoded_file = nullptr;

/// OpenCV's own memory, unless it is for a picture that is too large. It must stand in for the
/// allocator of all matrices: OpenCV takes that one where a single matrix's own refuses.
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

// Before main(), since OpenCV does not guard the change against other threads.
[[maybe_unused]] const bool kIsInstalled = [] {
  static LimitedAllocator allocator;
  cv::Mat::setDefaultAllocator(&allocator);
  return true;
}();

// What the stream of mute_codecs() is written.
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

}  // namespace

MegapixelLimit::MegapixelLimit(uint64_t megapixels) : before_(most_megapixels) {
  if (megapixels < 1 || megapixels > kMostMegapixels)
    throw Error(ErrorKind::usage, fmt::format("max_megapixels must be from 1 to {}, found {}",
                                              kMostMegapixels, megapixels));
  most_megapixels = megapixels;
}

MegapixelLimit::~MegapixelLimit() { most_megapixels = before_; }

void check_frame_size(const std::filesystem::path& file, uint64_t width, uint64_t height) {
  const uint64_t limit = most_megapixels;
  if (width == 0 || height <= limit * kMillion / width) return;
  const uint64_t needed = (width * height + kMillion - 1) / kMillion;
  throw Error(
      ErrorKind::usage,
      fmt::format(
          "{}: has {} x {} pixels, more than the {} megapixels that are allowed; {}", file.string(),
          width, height, limit,
          needed > kMostMegapixels
              ? "remove it, or make it smaller"
              : fmt::format("remove it, or give --max-megapixels {} if it is meant", needed)));
}

CodecScope::CodecScope(const std::filesystem::path& file) {
  assert(decoded_file == nullptr);
  decoded_file = &file;
}

CodecScope::~CodecScope() { decoded_file = nullptr; }

// glibc lets a program set the stream.
void mute_codecs() {
  std::FILE* const stream = ::fopencookie(nullptr, "w", {nullptr, pass_on, nullptr, nullptr});
  if (stream == nullptr) return;
  std::setvbuf(stream, nullptr, _IONBF, 0);
  stderr = stream;
}

}  // namespace vpr
