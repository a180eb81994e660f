#include "recordings/frames.h"

#include <cstring>
#include <map>
#include <mutex>
#include <thread>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <sys/resource.h>

#include "base/parallel.h"
#include "recordings/decode.h"
#include "recordings/sequence_source.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

struct Pass {
  Sequence sequence;
  std::map<size_t, cv::Mat> images;
};

Pass read_all(const SequenceArgument& argument, Unreadable unreadable = Unreadable::fail,
              const Monitor& monitor = {}) {
  Pass pass;
  std::mutex mutex;
  pass.sequence = for_each_frame(open_sequence(argument), PixelFormat::gray, unreadable, monitor,
                                 [&](size_t index, const cv::Mat& image) {
                                   const std::lock_guard lock(mutex);
                                   pass.images[index] = image.clone();
                                 });
  return pass;
}

bool same_pixels(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && cv::countNonZero(a != b) == 0;
}

std::string encoded(const std::string& extension, const cv::Mat& image,
                    const std::vector<int>& options = {}) {
  std::vector<uint8_t> bytes;
  REQUIRE(cv::imencode(extension, image, bytes, options));
  return {bytes.begin(), bytes.end()};
}

std::string jpeg_bytes(int width, int height) {
  cv::Mat image(height, width, CV_8UC1);
  cv::randu(image, 0, 256);
  return encoded(".jpg", image);
}

uint32_t png_checksum(std::string_view bytes) {
  uint32_t sum = ~uint32_t{0};
  for (const char byte : bytes) {
    sum ^= static_cast<uint8_t>(byte);
    for (int bit = 0; bit < 8; ++bit) sum = sum >> 1 ^ (sum % 2 != 0 ? 0xedb88320 : 0);
  }
  return ~sum;
}

std::string big_endian(uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift);
  return bytes;
}

/// A small PNG whose header claims a large size.
std::string png_that_claims(uint32_t width, uint32_t height) {
  std::string png = encoded(".png", cv::Mat(8, 8, CV_8UC3, cv::Scalar(1, 2, 3)));
  png.replace(16, 8, big_endian(width) + big_endian(height));
  png.replace(29, 4, big_endian(png_checksum(std::string_view(png).substr(12, 17))));
  return png;
}

long peak_memory_kib() {
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss;
}

}  // namespace

TEST_CASE("frames of a folder are decoded as OpenCV does, at their own index and size") {
  write_image("1.png", 1, 40, 30);
  write_image("2.jpg", 2, 17, 90);
  write_image("10.bmp", 3, 1, 1);
  const Pass pass = read_all({".", {}});
  CHECK(pass.sequence.frame_names == std::vector<std::string>{"1.png", "2.jpg", "10.bmp"});
  REQUIRE(pass.images.size() == 3);
  for (size_t i = 0; i < 3; ++i)
    CHECK(same_pixels(pass.images.at(i),
                      cv::imread(pass.sequence.frame_names[i], cv::IMREAD_GRAYSCALE)));
}

TEST_CASE("an undecodable frame is named, the first of several for any number of threads") {
  const std::string whole = jpeg_bytes(64, 48);
  const std::string png_start = "\x89PNG\r\n\x1a\n";
  const std::string bad =
      GENERATE_COPY(std::string(), std::string("no image"), whole.substr(0, whole.size() / 2),
                    whole.substr(0, 20), whole.substr(0, whole.size() - 2), png_start);
  const TemporaryFolder folder;
  for (int i = 0; i < 20; ++i) write_image(folder / fmt::format("{}.png", i), i);
  write_text(folder / "5.jpg", bad);
  write_text(folder / "15.jpg", bad);
  for (const size_t threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    const std::string text = error_text([&] { read_all({folder.path(), {}}); });
    CHECK(has(text, "/5.jpg"));
    const Pass pass = read_all({folder.path(), {}}, Unreadable::skip);
    CHECK(pass.sequence.frames == 22);
    CHECK(pass.sequence.unreadable == std::vector<size_t>{5, 16});
    CHECK(pass.images.size() == 20);
  }
}

TEST_CASE("a JPEG with a complete preview but a truncated image counts as truncated") {
  const std::string preview = jpeg_bytes(8, 8);
  std::string whole = jpeg_bytes(64, 48);
  const size_t length = preview.size() + 2;
  std::string segment = "\xff\xe1";
  segment += static_cast<char>(length >> 8);
  segment += static_cast<char>(length & 0xff);
  whole.insert(2, segment + preview);
  write_text("1.jpg", whole);
  CHECK(read_all({".", {}}).images.size() == 1);
  write_text("1.jpg", whole.substr(0, whole.size() - 200));
  CHECK(error_kind([&] { read_all({".", {}}); }) == ErrorKind::input);
}

TEST_CASE("images are accepted by their first bytes, not by their names") {
  const auto read = [&](const std::string& bytes) {
    write_text("1.png", bytes);
    return error_text([&] { read_all({".", {}}); });
  };
  cv::Mat image(128, 128, CV_8UC3);  // OpenJPEG cannot compress much smaller images
  cv::randu(image, 0, 256);
  for (const char* extension : {".jpg", ".png", ".tiff", ".bmp", ".ppm", ".webp"})
    CHECK(read(encoded(extension, image)).empty());
  CHECK(read(encoded(".pgm", image.reshape(1))).empty());
  CHECK(read("P2\n2 1\n255\n7 9\n").empty());

  std::string dicom = std::string(128, '\0') + "DICM";
  cv::Mat floats;
  image.convertTo(floats, CV_32FC3);
  for (const std::string& refused :
       {encoded(".jp2", image), encoded(".ras", image), encoded(".hdr", floats),
        encoded(".pfm", floats), dicom, "RIFF\x4\1\0\0WEBPVP8 " + dicom.substr(16),
        std::string("GIF89a"), std::string("v/1\x01"), std::string("P7\n"), std::string("x")}) {
    INFO(refused.substr(0, 10));
    CHECK(has(read(refused), "it is not a JPEG, PNG, TIFF, BMP, PPM, PGM or WebP image"));
  }
}

TEST_CASE("a progressive JPEG is decoded, and refused with thousands of scans") {
  cv::Mat image(48, 64, CV_8UC3);
  cv::randu(image, 0, 256);
  std::string jpeg = encoded(".jpg", image, {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
  write_text("1.jpg", jpeg);
  CHECK(read_all({".", {}}).images.size() == 1);
  const size_t last = jpeg.rfind("\xff\xda");
  const std::string scan = jpeg.substr(last, jpeg.size() - 2 - last);
  for (int i = 0; i < 3000; ++i) jpeg.insert(jpeg.size() - 2, scan);
  write_text("1.jpg", jpeg);
  CHECK(has(error_text([&] { read_all({".", {}}); }), "the JPEG has 3010 scans, more than 100"));
}

TEST_CASE("a file that is truncated during reading is reported as damaged, without a crash") {
  cv::Mat image(2000, 3000, CV_8UC3);
  cv::randu(image, 0, 256);
  cv::imwrite("1.bmp", image);
  const auto size = fs::file_size("1.bmp");
  for (int trial = 0; trial < 20; ++trial) {
    std::jthread writer([&] {
      fs::resize_file("1.bmp", 100);
      fs::resize_file("1.bmp", size);
    });
    try {
      decode_image("1.bmp", PixelFormat::gray);
    } catch (const Error& error) {
      CHECK(error.kind() == ErrorKind::input);
    }
  }
}

TEST_CASE("an image with more pixels than the limit is refused in any format") {
  const std::string extension =
      GENERATE(as<std::string>(), ".png", ".jpg", ".bmp", ".pgm", ".tiff", ".webp");
  const TemporaryFolder folder;
  const ProcessScope limit({.max_megapixels = 1});
  for (int i = 0; i < 6; ++i) write_image(folder / fmt::format("{}.png", i), i);
  write_image(folder / ("7" + extension), 7, 1000, 1000);
  CHECK(read_all({folder.path(), {}}).images.size() == 7);
  write_image(folder / ("8" + extension), 8, 1250, 1001);
  write_image(folder / ("9" + extension), 9, 2000, 1000);
  for (const Unreadable unreadable : {Unreadable::fail, Unreadable::skip}) {
    const auto read = [&] { read_all({folder.path(), {}}, unreadable); };
    CHECK(error_kind(read) == ErrorKind::usage);
    CHECK(error_text(read) == fmt::format("{}: has 1250 x 1001 pixels, more than the limit of 1 "
                                          "megapixels. Remove it, or pass --max-megapixels 2 to "
                                          "accept it",
                                          (folder / ("8" + extension)).string()));
  }
}

TEST_CASE("a small file that claims a large image does not allocate memory for it") {
  const auto refusal = [&](uint32_t width, uint32_t height) {
    write_text("1.png", png_that_claims(width, height));
    return error_text([&] { read_all({".", {}}); });
  };
  CHECK(has(refusal(9, 9), "can't be decoded"));
  const long before = peak_memory_kib();
  CHECK(has(refusal(20'000, 20'000), "--max-megapixels 400 "));
  CHECK(has(refusal(32'768, 32'768), "make it smaller"));
  CHECK(has(refusal(1'000'000, 1'000'000), "make it smaller"));
  CHECK(peak_memory_kib() - before < 50 * 1024);
}

TEST_CASE("invalid pixel limits are refused, and limits end with their scope") {
  CHECK(error_kind([] { const ProcessScope none({.max_megapixels = 0}); }) == ErrorKind::usage);
  CHECK(error_kind([] { const ProcessScope more({.max_megapixels = kMaxMegapixels + 1}); }) ==
        ErrorKind::usage);
  const ProcessScope outer({.max_megapixels = 2});
  {
    const ProcessScope inner({.max_megapixels = 1});
    CHECK(error_kind([] { check_frame_size("x", 1001, 1000); }) == ErrorKind::usage);
  }
  check_frame_size("x", 2000, 1000);
  check_frame_size("x", 0, 0);
  CHECK(error_kind([] { check_frame_size("x", 2000, 1001); }) == ErrorKind::usage);
}

TEST_CASE("a sequence without readable frames is an error even with --skip-unreadable") {
  write_text("1.png", "");
  CHECK(error_kind([&] { read_all({".", {}}, Unreadable::skip); }) == ErrorKind::input);
}

TEST_CASE("a stop request ends the pass") {
  write_image("1.png", 1);
  std::atomic<bool> stop{true};
  Monitor monitor;
  monitor.stop = &stop;
  CHECK(error_kind([&] {
          read_all({".", {}}, Unreadable::fail, monitor);
        }) == ErrorKind::interrupted);
}

TEST_CASE("a warning counts the images in subfolders, which are not searched") {
  const TemporaryFolder folder;
  for (const char* name : {"1.png", "a/2.png", "a/3.png", ".b/4.png"}) {
    fs::create_directories((folder / name).parent_path());
    write_image(folder / name, 1);
  }
  Warnings warnings;
  CHECK(read_all({folder.path(), {}}, Unreadable::fail, warnings.monitor).images.size() == 1);
  REQUIRE(warnings.said.size() == 1);
  CHECK(has(warnings.said[0], "2 images in its subfolders"));
}

TEST_CASE("a video is read frame by frame, within its range") {
  const std::string path = "walk.avi";
  std::vector<int> levels;
  for (int i = 0; i < 12; ++i) levels.push_back(20 * i + 5);
  write_video(path, 32, 24, levels);
  const Pass all = read_all({path, {}});
  REQUIRE(all.images.size() == 12);
  for (size_t i = 0; i < 12; ++i) CHECK(std::abs(cv::mean(all.images.at(i))[0] - levels[i]) < 4);
  const Pass part = read_all({path, {3, 10, 3}});
  CHECK(part.sequence.frame_names == std::vector<std::string>{"#3", "#6", "#9"});
  for (size_t i = 0; i < 3; ++i) CHECK(same_pixels(part.images.at(i), all.images.at(3 + 3 * i)));
  CHECK(error_kind([&] { read_all({path, {0, 13, 1}}); }) == ErrorKind::usage);
  CHECK(error_kind([&] { read_all({path, {12, std::nullopt, 1}}); }) == ErrorKind::usage);
}

TEST_CASE("a video that counts repeated frames without storing them has its own rate") {
  const TemporaryFolder folder;
  const fs::path path = folder / "repeats.avi";
  write_video(path, 32, 24, std::vector<int>(12, 9), 30);
  std::string file = read_text(path);
  size_t at = file.find("movi") + 4;
  size_t size_in_index = file.find("idx1", at) + 8 + 12;
  REQUIRE(file.compare(at, 4, "00dc") == 0);
  for (int i = 0; file.compare(at, 4, "00dc") == 0; ++i, size_in_index += 16) {
    uint32_t size = 0;
    std::memcpy(&size, &file[at + 4], 4);
    if (i % 4 != 0) {  // an empty frame, and a chunk that is ignored
      const uint32_t rest = size - 8;
      file.replace(at + 4, 8, std::string(4, '\0') + "JUNK").replace(size_in_index, 4, 4, '\0');
      std::memcpy(&file[at + 12], &rest, 4);
    }
    at += 8 + size + size % 2;
  }
  write_text(path, file);
  SequenceArgument argument{path, {}};
  argument.sequence.fps = 30;
  const Sequence sequence = read_all(argument).sequence;
  CHECK(sequence.frames == 3);
  CHECK(sequence.fps == Approx(7.5));
}

TEST_CASE("a video with frames above the limit is refused before decoding") {
  const std::string path = "walk.avi";
  write_video(path, 1280, 1024, {9});
  CHECK(read_all({path, {}}).images.size() == 1);
  const ProcessScope limit({.max_megapixels = 1});
  for (const Unreadable unreadable : {Unreadable::fail, Unreadable::skip})
    CHECK(has(error_text([&] { read_all({path, {}}, unreadable); }), "has 1280 x 1024 pixels"));
}

TEST_CASE("a file that is not a video is an input error") {
  write_text("walk.mp4", "not a video");
  CHECK(error_kind([&] { read_all({"walk.mp4", {}}); }) == ErrorKind::input);
}
