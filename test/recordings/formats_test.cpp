// Images and videos that are easily misread: order, rotation, pixel ranges, refused formats.
#include <map>
#include <mutex>

#include <catch2/catch.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "recordings/decode.h"
#include "recordings/frames.h"
#include "recordings/sequence_source.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

std::map<size_t, cv::Mat> frames_of(const fs::path& path) {
  std::map<size_t, cv::Mat> frames;
  std::mutex mutex;
  for_each_frame(open_sequence({path, {}}), PixelFormat::gray, Unreadable::fail, {},
                 [&](size_t index, const cv::Mat& image) {
                   const std::scoped_lock lock(mutex);
                   frames[index] = image.clone();
                 });
  return frames;
}

std::vector<std::string> order_of(const fs::path& folder, const std::vector<std::string>& names) {
  for (const std::string& name : names) write_image(folder / name, 1);
  return file_names(open_sequence({folder, {}}));
}

// A video whose upper left quarter is bright, with a display matrix for a clockwise rotation, after
// the frames were flipped upside down if `is_mirrored`.
fs::path video(const fs::path& folder, int rotation, bool is_mirrored) {
  const fs::path path = folder / "v.mp4";
  {
    cv::VideoWriter writer(path, cv::VideoWriter::fourcc('m', 'p', '4', 'v'), 10, {160, 120});
    if (!writer.isOpened()) return {};
    cv::Mat frame(120, 160, CV_8UC3, cv::Scalar::all(20));
    frame(cv::Rect(0, 0, 80, 60)).setTo(cv::Scalar::all(230));
    for (int i = 0; i < 3; ++i) writer.write(frame);
  }
  std::string bytes = read_text(path);
  const size_t matrix = bytes.find("tkhd") + 4 + 40;
  const auto set = [&](size_t cell, int value) {
    const auto number = static_cast<uint32_t>(value * 65536);
    for (size_t i = 0; i < 4; ++i)
      bytes[matrix + 4 * cell + i] = static_cast<char>(number >> (24 - 8 * i));
  };
  const int cosine = rotation == 0 ? 1 : rotation == 180 ? -1 : 0;
  const int sine = rotation == 90 ? 1 : rotation == 270 ? -1 : 0;
  set(0, cosine);
  set(1, sine);
  set(3, is_mirrored ? sine : -sine);
  set(4, is_mirrored ? -cosine : cosine);
  write_text(path, bytes);
  return path;
}

std::string little(uint64_t value, size_t bytes) {
  std::string text;
  for (size_t i = 0; i < bytes; ++i) text += static_cast<char>(value >> 8 * i);
  return text;
}

// A TIFF file with these tags and without pixels. The values are of 4 bytes or, after the tags, 8.
std::string tiff(const std::vector<std::pair<uint64_t, uint64_t>>& tags, bool is_long8 = false) {
  std::string file = "II*" + little(0, 1) + little(8, 4) + little(tags.size(), 2);
  std::string values = little(0, 4);
  for (const auto& [tag, value] : tags) {
    const uint64_t where = 8 + 2 + 12 * tags.size() + values.size();
    file += little(tag, 2) + little(is_long8 ? 16 : 4, 2) + little(1, 4);
    file += little(is_long8 ? where : value, 4);
    values += little(value, 8);
  }
  return file + values;
}

}  // namespace

TEST_CASE("a video is shown upright, whatever its display matrix") {
  const TemporaryFolder folder;
  const bool is_mirrored = GENERATE(false, true);
  for (const int rotation : {0, 90, 180, 270}) {
    const fs::path path = video(folder.path(), rotation, is_mirrored);
    REQUIRE_FALSE(path.empty());  // OpenCV has an encoder
    INFO(rotation);
    const cv::Mat frame = frames_of(path).at(0);
    const bool is_turned = rotation % 180 != 0;
    REQUIRE(frame.size() == (is_turned ? cv::Size(120, 160) : cv::Size(160, 120)));
    // A clockwise turn moves the bright quarter from the upper left to the upper right, and so on.
    const int quarter = (rotation / 90 + (is_mirrored ? 3 : 0)) % 4;
    const int x = quarter == 1 || quarter == 2 ? frame.cols * 3 / 4 : frame.cols / 4;
    const int y = quarter >= 2 ? frame.rows * 3 / 4 : frame.rows / 4;
    CHECK(frame.at<uint8_t>(y, x) > 150);
    CHECK(cv::mean(frame)[0] < 110);
  }
}

TEST_CASE("16-bit gray and color are scaled by the range of their sequence") {
  const TemporaryFolder folder;
  const std::string extension = GENERATE(as<std::string>(), ".png", ".tif", ".pgm", ".ppm");
  for (int i = 0; i < 3; ++i) {
    cv::Mat image(8, 8, CV_16UC1, cv::Scalar(27000 + 50 * i));
    image.at<uint16_t>(0, 0) = static_cast<uint16_t>(27000 + 50 * i + 55);
    if (extension == ".ppm") cv::cvtColor(image, image, cv::COLOR_GRAY2BGR);
    cv::imwrite(folder / (std::to_string(i) + extension), image);
  }
  const auto frames = frames_of(folder.path());
  CHECK(frames.at(0).at<uint8_t>(1, 1) == 0);    // 27000
  CHECK(frames.at(0).at<uint8_t>(0, 0) == 90);   // 27055, of 155
  CHECK(frames.at(1).at<uint8_t>(1, 1) == 82);   // 27050
  CHECK(frames.at(2).at<uint8_t>(0, 0) == 255);  // 27155
}

TEST_CASE("the gray of a color image follows from its pixels, whatever gamma the file states") {
  const TemporaryFolder folder;
  cv::Mat image(8, 8, CV_8UC3);
  cv::randu(image, 0, 256);
  cv::Mat gray;
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  for (const char* name : {"1.png", "1.bmp", "1.ppm", "1.tif"}) cv::imwrite(folder / name, image);
  std::string png = read_text(folder / "1.png");
  png.insert(png.find("IDAT") - 4, std::string("\0\0\0\1sRGB\0\xae\xce\x1c\xe9", 13));
  write_text(folder / "2.png", png);
  for (const char* name : {"1.png", "1.bmp", "1.ppm", "1.tif", "2.png"}) {
    INFO(name);
    const cv::Mat read = decode_image(folder / name, PixelFormat::gray);
    REQUIRE(read.type() == CV_8UC1);
    CHECK(cv::countNonZero(read != gray) == 0);
  }
}

TEST_CASE("frames named by decimal numbers are ordered by value, and UTM names of rows as bytes") {
  const TemporaryFolder folder;
  SECTION("decimal numbers") {
    const std::vector<std::vector<std::string>> orders = {
        {"3081.96.png", "3082.0.png", "3082.08.png", "3082.2.png"},
        {"left_8.08.png", "left_8.2.png", "left_10.1.png", "right_8.08.png", "right_8.2.png"},
        {"7.96.png", "8.png", "8.12.png"},
        {"-0.25.png", "-0.12.png", "1e-05.png", "0.12.png"},
        {"9.125s.png", "9.25s.png", "10.5s.png"}};
    for (const std::vector<std::string>& names : orders)
      CHECK(order_of(TemporaryFolder().path(), names) == names);
  }
  SECTION("numbers of sections, of which two have one value") {
    CHECK(order_of(folder.path(), {"1.10.png", "1.9.png", "1.1.png"}) ==
          std::vector<std::string>{"1.1.png", "1.9.png", "1.10.png"});
  }
  SECTION("numbers whose order is unclear") {
    for (const char* name : {"map.png", "8.140000000.png"}) {
      const TemporaryFolder mixed;
      CHECK_THROWS_WITH(order_of(mixed.path(), {"8.3.png", "8.png", name}),
                        Catch::Contains(name) && Catch::Contains("--order natural"));
    }
  }
  SECTION("UTM names") {
    const std::vector<std::string> names = {"a@0@9.5@.png", "a@0@11.9@.png"};
    CHECK(order_of(folder.path(), names) == names);
    const ProcessScope process({.order = FrameOrder::rows});
    CHECK(order_of(folder.path(), names) == std::vector<std::string>{names[1], names[0]});
  }
  SECTION("as stated") {
    const std::vector<std::string> names = {"10.png", "9.png", "0011.png"};
    CHECK(order_of(folder.path(), names) ==
          std::vector<std::string>{"9.png", "10.png", "0011.png"});
    {
      const ProcessScope process({.order = FrameOrder::name});
      CHECK(order_of(folder.path(), names) ==
            std::vector<std::string>{"0011.png", "10.png", "9.png"});
    }
    const ProcessScope process({.order = FrameOrder::time});
    CHECK(order_of(folder.path(), names).front() == "9.png");
    write_image(folder / "a.png", 1);
    CHECK_THROWS_WITH(open_sequence({folder.path(), {}}), Catch::Contains("--order time"));
  }
}

TEST_CASE("images that would shift frame numbers, and formats that are not read, are refused") {
  const TemporaryFolder folder;
  write_image(folder / "1.png", 1);
  for (const char* name : {"2.HEIC", "2.GIF", "2.jp2", "2.pbm", "2.dng", "2.j2c"}) {
    write_text(folder / name, "x");
    CHECK_THROWS_WITH(open_sequence({folder.path(), {}}),
                      Catch::Contains(name) && Catch::Contains("not supported") &&
                          Catch::Contains("*" + fs::path(name).extension().string()));
    fs::remove(folder / name);
  }
  write_text(folder / "1.dng", "x");
  write_image(folder / "2.png", 1);
  fs::rename(folder / "2.png", folder / "2.dib");
  CHECK(file_names(open_sequence({folder.path(), {}})).size() == 2);
  cv::imwrite(folder / "f.tif", cv::Mat(4, 4, CV_32FC1, cv::Scalar(0.5)));
  CHECK_THROWS_WITH(decode_image(folder / "f.tif", PixelFormat::gray),
                    Catch::Contains("floating-point"));
  CHECK(read_image_header(tiff({{258, 16}, {262, 1}})).unread.empty());
  CHECK(read_image_header(tiff({{258, 32}, {262, 1}})).unread == "32-bit");
  CHECK(read_image_header(tiff({{258, 16}, {262, 0}})).unread == "inverted (MINISWHITE)");
  write_text(folder / "s.tif", tiff({{256, 1}, {257, 1}, {258, 16}, {262, 1}, {339, 2}}));
  CHECK_THROWS_WITH(decode_image(folder / "s.tif", PixelFormat::gray),
                    Catch::Contains("signed pixels"));
  const cv::Mat page(4, 4, CV_8UC1, cv::Scalar(9));
  cv::imwritemulti(folder / "p.tif", std::vector<cv::Mat>{page, page});
  CHECK_THROWS_WITH(decode_image(folder / "p.tif", PixelFormat::gray),
                    Catch::Contains("several pages"));
  // A second directory at byte 34: a smaller copy of the first page, then a page.
  std::string file = tiff({{258, 16}});
  file.replace(22, 4, little(34, 4));
  file += little(1, 2) + little(254, 2) + little(4, 2) + little(1, 4) + little(1, 4) + little(0, 4);
  CHECK_FALSE(read_image_header(file).has_pages);
  file[44] = 0;
  CHECK(read_image_header(file).has_pages);
  file.replace(22, 4, little(900, 4));  // beyond the end
  CHECK_FALSE(read_image_header(file).has_pages);
  // Tiles of 32768 x 32768 pixels for an image of one pixel.
  for (const bool is_long8 : {false, true}) {
    write_text(folder / "t.tif", tiff({{322, 32768}, {322, 16}, {323, 32768}}, is_long8));
    CHECK_THROWS_WITH(decode_image(folder / "t.tif", PixelFormat::gray),
                      Catch::Contains("32768 x 32768"));
  }
  write_text(folder / "list.mp4", "#EXTM3U\n# \xc3\xbc\n#EXTINF:1.2,\nsecret.ts\n#EXT-X-ENDLIST\n");
  CHECK_THROWS_WITH(frames_of(folder / "list.mp4"), Catch::Contains("playlists are not read"));
}

TEST_CASE("the EXIF orientation of a WebP image is read") {
  const std::string exif = tiff({{274, 6}});
  const std::string chunks =
      "WEBPVP8X" + little(10, 4) + std::string(10, '\0') + "EXIF" + little(exif.size(), 4) + exif;
  CHECK(read_image_header("RIFF" + little(chunks.size(), 4) + chunks).orientation == 6);
  CHECK(read_image_header("RIFF").orientation == 1);
}
