#include "images/frames.h"

#include <map>
#include <mutex>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "base/error.h"
#include "base/parallel.h"
#include "support.h"

using namespace vpr;
namespace fs = std::filesystem;

namespace {

struct Pass {
  FrameList frames;
  std::map<size_t, cv::Mat> images;
};

Pass read_all(const SequenceArgument& argument, Unreadable unreadable = Unreadable::fail,
              const Monitor& monitor = {}) {
  Pass pass;
  std::mutex mutex;
  pass.frames = for_each_frame(open_sequence(argument), PixelFormat::grey, unreadable, monitor,
                               [&](size_t index, const cv::Mat& image) {
                                 const std::lock_guard lock(mutex);
                                 pass.images[index] = image.clone();
                               });
  return pass;
}

bool same_pixels(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && cv::countNonZero(a != b) == 0;
}

std::string jpeg_bytes(int width, int height) {
  cv::Mat image(height, width, CV_8UC1);
  cv::randu(image, 0, 256);
  std::vector<uint8_t> bytes;
  cv::imencode(".jpg", image, bytes);
  return {bytes.begin(), bytes.end()};
}

}  // namespace

TEST_CASE("frames of a folder are decoded as OpenCV does, at their own index and size") {
  const test::TemporaryFolder folder;
  test::write_image(folder / "1.png", 1, 40, 30);
  test::write_image(folder / "2.jpg", 2, 17, 90);
  test::write_image(folder / "10.bmp", 3, 1, 1);
  const Pass pass = read_all({folder.path(), {}});
  CHECK(pass.frames.names == std::vector<std::string>{"1.png", "2.jpg", "10.bmp"});
  REQUIRE(pass.images.size() == 3);
  for (size_t i = 0; i < 3; ++i)
    CHECK(same_pixels(pass.images.at(i),
                      cv::imread((folder / pass.frames.names[i]).string(), cv::IMREAD_GRAYSCALE)));
}

TEST_CASE("a frame that can't be decoded is named, the first of several on any number of threads") {
  const std::string whole = jpeg_bytes(64, 48);
  const std::string png_start = "\x89PNG\r\n\x1a\n";
  const std::string bad =
      GENERATE_COPY(std::string(), std::string("no image"), whole.substr(0, whole.size() / 2),
                    whole.substr(0, 20), whole.substr(0, whole.size() - 2), png_start);
  const test::TemporaryFolder folder;
  for (int i = 0; i < 20; ++i) test::write_image(folder / fmt::format("{}.png", i), i);
  test::write_text(folder / "5.jpg", bad);
  test::write_text(folder / "15.jpg", bad);
  for (const size_t threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    const std::string text = test::error_text([&] { read_all({folder.path(), {}}); });
    CHECK(text.find("/5.jpg") != std::string::npos);
    const Pass pass = read_all({folder.path(), {}}, Unreadable::skip);
    CHECK(pass.frames.count() == 22);
    CHECK(pass.frames.unreadable == std::vector<size_t>{5, 16});
    CHECK(pass.images.size() == 20);
  }
}

TEST_CASE("a JPEG whose preview is complete but whose picture is cut counts as truncated") {
  const std::string preview = jpeg_bytes(8, 8);
  std::string whole = jpeg_bytes(64, 48);
  const size_t length = preview.size() + 2;
  std::string segment = "\xff\xe1";
  segment += static_cast<char>(length >> 8);
  segment += static_cast<char>(length & 0xff);
  whole.insert(2, segment + preview);
  const test::TemporaryFolder folder;
  test::write_text(folder / "1.jpg", whole);
  CHECK(read_all({folder.path(), {}}).images.size() == 1);
  test::write_text(folder / "1.jpg", whole.substr(0, whole.size() - 200));
  CHECK(test::error_kind([&] { read_all({folder.path(), {}}); }) == ErrorKind::input);
}

TEST_CASE("a sequence without any readable frame is an error even if they may be skipped") {
  const test::TemporaryFolder folder;
  test::write_text(folder / "1.png", "");
  CHECK(test::error_kind([&] {
          read_all({folder.path(), {}}, Unreadable::skip);
        }) == ErrorKind::input);
}

TEST_CASE("a wish to stop ends the pass") {
  const test::TemporaryFolder folder;
  test::write_image(folder / "1.png", 1);
  std::atomic<bool> stop{true};
  Monitor monitor;
  monitor.stop = &stop;
  CHECK(test::error_kind([&] {
          read_all({folder.path(), {}}, Unreadable::fail, monitor);
        }) == ErrorKind::interrupted);
}

TEST_CASE("a video is read frame after frame, and cut to its range") {
  const test::TemporaryFolder folder;
  const std::string path = folder / "walk.avi";
  {
    cv::VideoWriter writer(path, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10, {32, 24});
    REQUIRE(writer.isOpened());
    for (int i = 0; i < 12; ++i) {
      const int grey = 20 * i + 5;
      writer.write(cv::Mat(24, 32, CV_8UC3, cv::Scalar(grey, grey, grey)));
    }
  }
  const Pass all = read_all({path, {}});
  REQUIRE(all.images.size() == 12);
  for (size_t i = 0; i < 12; ++i)
    CHECK(std::abs(cv::mean(all.images.at(i))[0] - (20.0 * static_cast<double>(i) + 5)) < 4);
  const Pass part = read_all({path, {3, 10, 3}});
  CHECK(part.frames.names == std::vector<std::string>{"#3", "#6", "#9"});
  for (size_t i = 0; i < 3; ++i) CHECK(same_pixels(part.images.at(i), all.images.at(3 + 3 * i)));
  CHECK(test::error_kind([&] { read_all({path, {0, 13, 1}}); }) == ErrorKind::usage);
  CHECK(test::error_kind([&] { read_all({path, {12, std::nullopt, 1}}); }) == ErrorKind::usage);
}

TEST_CASE("a file that is no video is an input error") {
  const test::TemporaryFolder folder;
  test::write_text(folder / "walk.mp4", "not a video");
  CHECK(test::error_kind([&] { read_all({folder / "walk.mp4", {}}); }) == ErrorKind::input);
}
