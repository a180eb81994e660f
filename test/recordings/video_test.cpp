// Videos as phones, editors and thermal cameras write them, made by FFmpeg's libraries.
#include "recordings/video.h"

#include <functional>
#include <map>
#include <memory>
#include <mutex>

#include <catch2/catch.hpp>
#include <opencv2/core.hpp>

#include "recordings/frames.h"
#include "support.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/log.h>
}

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

namespace {

constexpr int kWidth = 96;
constexpr int kHeight = 70;  // not a multiple of any codec's blocks

/// The brightness of a frame, from 20 to 220.
int level_of(size_t frame) { return 20 + static_cast<int>(frame * 17 % 200); }

void fill_gray(AVFrame& picture, size_t frame) {
  for (int plane = 0; plane < 3 && picture.data[plane] != nullptr; ++plane) {
    const int rows = plane == 0 ? kHeight : kHeight / 2;
    const int columns = plane == 0 ? kWidth : kWidth / 2;
    const int value = plane == 0 ? 16 + level_of(frame) * 219 / 255 : 128;
    for (int y = 0; y < rows; ++y)
      for (int x = 0; x < columns; ++x) {
        uint8_t* const row = picture.data[plane] + y * picture.linesize[plane];
        if (picture.format == AV_PIX_FMT_YUV420P10)
          reinterpret_cast<uint16_t*>(row)[x] = static_cast<uint16_t>(value * 4);
        else
          row[x] = static_cast<uint8_t>(value);
      }
  }
}

struct Encoding {
  std::string codec;
  AVPixelFormat pixels = AV_PIX_FMT_YUV420P;
  std::function<void(AVFrame&, size_t)> fill = fill_gray;
  AVColorRange range = AVCOL_RANGE_UNSPECIFIED;
};

/// Writes a video with frames at these times, in hundredths of a second; an MP4 video hides those
/// below 0 by an edit list.
void write_coded(const fs::path& path, const Encoding& encoding,
                 const std::vector<int64_t>& times) {
  av_log_set_level(AV_LOG_QUIET);
  AVFormatContext* file = nullptr;
  REQUIRE(avformat_alloc_output_context2(&file, nullptr, nullptr, path.c_str()) >= 0);
  const AVCodec* const encoder = avcodec_find_encoder_by_name(encoding.codec.c_str());
  REQUIRE(encoder != nullptr);
  AVCodecContext* codec = avcodec_alloc_context3(encoder);
  codec->width = kWidth;
  codec->height = kHeight;
  codec->pix_fmt = encoding.pixels;
  codec->color_range = encoding.range;
  codec->time_base = {1, 100};
  codec->framerate = {10, 1};
  codec->bit_rate = 8'000'000;
  codec->thread_count = 1;
  if (encoding.codec == "mpeg4") codec->max_b_frames = 2;
  if ((file->oformat->flags & AVFMT_GLOBALHEADER) != 0) codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  AVDictionary* options = nullptr;
  av_dict_set(&options, "cpu-used", "8", 0);
  av_dict_set(&options, "x265-params", "log-level=none", 0);
  REQUIRE(avcodec_open2(codec, encoder, &options) == 0);
  av_dict_free(&options);
  AVStream* const stream = avformat_new_stream(file, nullptr);
  stream->time_base = codec->time_base;
  stream->avg_frame_rate = codec->framerate;
  avcodec_parameters_from_context(stream->codecpar, codec);
  REQUIRE(avio_open(&file->pb, path.c_str(), AVIO_FLAG_WRITE) >= 0);
  REQUIRE(avformat_write_header(file, nullptr) >= 0);
  AVFrame* picture = av_frame_alloc();
  AVPacket* packet = av_packet_alloc();
  for (size_t i = 0; i <= times.size(); ++i) {
    if (i < times.size()) {
      picture->width = kWidth;
      picture->height = kHeight;
      picture->format = encoding.pixels;
      REQUIRE(av_frame_get_buffer(picture, 0) == 0);
      encoding.fill(*picture, i);
      picture->pts = times[i];
    }
    REQUIRE(avcodec_send_frame(codec, i < times.size() ? picture : nullptr) == 0);
    av_frame_unref(picture);
    while (avcodec_receive_packet(codec, packet) == 0) {
      av_packet_rescale_ts(packet, codec->time_base, stream->time_base);
      REQUIRE(av_interleaved_write_frame(file, packet) == 0);
    }
  }
  REQUIRE(av_write_trailer(file) == 0);
  avio_closep(&file->pb);
  av_packet_free(&packet);
  av_frame_free(&picture);
  avcodec_free_context(&codec);
  avformat_free_context(file);
}

std::vector<int64_t> even_times(size_t frames, int64_t first = 0) {
  std::vector<int64_t> times;
  for (size_t i = 0; i < frames; ++i) times.push_back(first + 10 * static_cast<int64_t>(i));
  return times;
}

struct Reading {
  Sequence sequence;
  std::map<size_t, cv::Mat> images;
  Warnings warnings;

  explicit Reading(const fs::path& path, Unreadable unreadable = Unreadable::fail) {
    SequenceArgument argument{path, {}};
    argument.sequence.fps = VideoReader(argument, {}, Unreadable::skip).frames_per_second();
    std::mutex mutex;
    sequence = for_each_frame(open_sequence(argument), PixelFormat::gray, unreadable,
                              warnings.monitor, [&](size_t index, const cv::Mat& image) {
                                const std::scoped_lock lock(mutex);
                                images[index] = image.clone();
                              });
  }
};

// Whether all pixels of the image have the brightness of a frame.
bool shows(const cv::Mat& image, size_t frame) {
  double low = 0;
  double high = 0;
  cv::minMaxIdx(image, &low, &high);
  return low > level_of(frame) - 5 && high < level_of(frame) + 5;
}

}  // namespace

TEST_CASE(
    "frames have the times of the container, also after frames that are stored out of order") {
  const auto [codec, name] = GENERATE(table<std::string, std::string>({{"libx264", "v.mp4"},
                                                                       {"libx264", "v.mkv"},
                                                                       {"libx264", "v.ts"},
                                                                       {"libx265", "v.mp4"},
                                                                       {"libaom-av1", "v.mkv"},
                                                                       {"libvpx-vp9", "v.webm"},
                                                                       {"mpeg4", "v.mp4"},
                                                                       {"mjpeg", "v.mov"}}));
  CAPTURE(codec, name);
  const TemporaryFolder folder;
  const fs::path path = folder / name;
  // Half a second without frames, four times.
  std::vector<int64_t> times;
  for (int64_t i = 0; i < 20; ++i) times.push_back(10 * i + 50 * (i / 4));
  write_coded(path, {codec, codec == "mjpeg" ? AV_PIX_FMT_YUVJ420P : AV_PIX_FMT_YUV420P}, times);
  Warnings warnings;
  const std::vector<int64_t> read = read_video_times({path, {}}, warnings.monitor);
  REQUIRE(read.size() == times.size());
  for (size_t i = 0; i < times.size(); ++i) CHECK(read[i] == times[i] * 10'000'000);
  CHECK(read_video_times({path, {18, std::nullopt, 1}}, {}).back() == read.back());
  CHECK(warnings.said.empty());
  const Reading reading(path);  // also if the container does not count its frames
  CHECK(reading.sequence.frames == times.size());
  CHECK(*reading.sequence.fps == Approx(19 / 3.9).epsilon(0.05));
}

TEST_CASE("frames that the edit list of a trimmed video hides do not count") {
  const std::string codec = GENERATE(as<std::string>(), "libx264", "libx265", "libaom-av1");
  CAPTURE(codec);
  const TemporaryFolder folder;
  const fs::path path = folder / "trimmed.mp4";
  write_coded(path, {codec}, even_times(20, -50));
  const Reading reading(path);
  REQUIRE(reading.sequence.frames == 15);
  for (size_t i = 0; i < 15; ++i) CHECK(shows(reading.images.at(i), 5 + i));
  const std::vector<int64_t> times = read_video_times({path, {}}, {});
  CHECK(times.front() == 0);
  CHECK(times.back() == 1'400'000'000);
}

TEST_CASE("10-bit color is read to the last row of a height that is not a multiple of blocks") {
  const std::string codec = GENERATE(as<std::string>(), "libx264", "libx265");
  CAPTURE(codec);
  const TemporaryFolder folder;
  const fs::path path = folder / "deep.mp4";
  write_coded(path, {codec, AV_PIX_FMT_YUV420P10}, even_times(6));
  const Reading reading(path);
  REQUIRE(reading.images.size() == 6);
  for (size_t i = 0; i < 6; ++i) {
    CHECK(reading.images.at(i).size() == cv::Size(kWidth, kHeight));
    CHECK(shows(reading.images.at(i), i));
  }
}

TEST_CASE("16-bit video is scaled by the range of its frames") {
  const AVPixelFormat format =
      GENERATE(as<AVPixelFormat>(), AV_PIX_FMT_GRAY16LE, AV_PIX_FMT_YUV420P16LE);
  const TemporaryFolder folder;
  const fs::path path = folder / "thermal.mkv";
  const auto fill = [](AVFrame& picture, size_t frame) {
    for (int y = 0; y < kHeight; ++y) {
      auto* const row = reinterpret_cast<uint16_t*>(picture.data[0] + y * picture.linesize[0]);
      std::fill_n(row, kWidth, static_cast<uint16_t>(27000 + 50 * frame));
    }
    reinterpret_cast<uint16_t*>(picture.data[0])[0] = static_cast<uint16_t>(27055 + 50 * frame);
    for (int plane = 1; plane < 3 && picture.data[plane] != nullptr; ++plane)
      for (int y = 0; y < kHeight / 2; ++y)
        std::fill_n(reinterpret_cast<uint16_t*>(picture.data[plane] + y * picture.linesize[plane]),
                    kWidth / 2, uint16_t{0x8000});
  };
  write_coded(path, {"ffv1", format, fill}, even_times(3));
  const Reading reading(path);
  const auto gray = [&](size_t frame, int at) {
    return static_cast<double>(reading.images.at(frame).at<uint8_t>(at, at));
  };
  CHECK(gray(0, 1) == Approx(0).margin(1));    // 27000
  CHECK(gray(0, 0) == Approx(90).margin(1));   // 27055, of 155
  CHECK(gray(1, 1) == Approx(82).margin(1));   // 27050
  CHECK(gray(2, 0) == Approx(255).margin(1));  // 27155
}

TEST_CASE("a video of full range has the same gray in every codec") {
  const std::string codec = GENERATE(as<std::string>(), "libx264", "libx265", "libvpx-vp9", "ffv1");
  CAPTURE(codec);
  const TemporaryFolder folder;
  const fs::path path = folder / "full.mkv";
  const auto fill = [](AVFrame& picture, size_t) {
    for (int plane = 0; plane < 3; ++plane)
      for (int y = 0; y < (plane == 0 ? kHeight : kHeight / 2); ++y)
        std::fill_n(picture.data[plane] + y * picture.linesize[plane],
                    plane == 0 ? kWidth : kWidth / 2, static_cast<uint8_t>(plane == 0 ? 60 : 128));
  };
  write_coded(path, {codec, AV_PIX_FMT_YUV420P, fill, AVCOL_RANGE_JPEG}, even_times(3));
  CHECK(std::abs(cv::mean(Reading(path).images.at(1))[0] - 60) < 1.5);
}

TEST_CASE("the range may change within a video") {
  const TemporaryFolder folder;
  std::string bytes;
  for (const AVColorRange range : {AVCOL_RANGE_JPEG, AVCOL_RANGE_MPEG}) {
    write_coded(folder / "part.ts", {"libx265", AV_PIX_FMT_YUV420P10, fill_gray, range},
                even_times(3));
    bytes += read_text(folder / "part.ts");
  }
  write_text(folder / "both.ts", bytes);
  const Reading reading(folder / "both.ts", Unreadable::skip);
  REQUIRE(reading.images.size() == 6);
  CHECK_FALSE(shows(reading.images.at(1), 1));
  CHECK(shows(reading.images.at(4), 1));
}

TEST_CASE("an AVI that was written to a pipe does not state its duration") {
  const TemporaryFolder folder;
  write_coded(folder / "v.avi", {"mjpeg", AV_PIX_FMT_YUVJ420P}, even_times(12));
  std::string bytes = read_text(folder / "v.avi");
  const std::string unknown("\0\0\0\x40", 4);
  for (const auto& [chunk, offset] : {std::pair("avih", 24), std::pair("strh", 40)})
    bytes.replace(bytes.find(chunk) + offset, unknown.size(), unknown);
  write_text(folder / "v.avi", bytes);
  CHECK(Reading(folder / "v.avi").sequence.frames == 12);
}

TEST_CASE("a video without times has those of its rate, with a warning") {
  const auto [codec, name] =
      GENERATE(table<std::string, std::string>({{"libx264", "raw.h264"}, {"mjpeg", "raw.mjpeg"}}));
  const TemporaryFolder folder;
  const fs::path path = folder / name;
  write_coded(path, {codec, codec == "mjpeg" ? AV_PIX_FMT_YUVJ420P : AV_PIX_FMT_YUV420P},
              even_times(12));
  Warnings warnings;
  const auto times = read_video_times({path, {2, std::nullopt, 1}}, warnings.monitor);
  const double fps = VideoReader({path, {}}, {}, Unreadable::fail).frames_per_second();
  REQUIRE(times.size() == 10);
  for (size_t i = 0; i < 10; ++i)
    CHECK(times[i] == std::llround(static_cast<double>(i + 2) * 1e9 / fps));
  REQUIRE(warnings.said.size() == 1);
  CHECK(has(warnings.said[0], "the times of its frames are unknown"));
}

TEST_CASE("a damaged frame keeps its index, and its time is interpolated") {
  const TemporaryFolder folder;
  const fs::path path = folder / "damaged.mkv";
  write_coded(path, {"mjpeg", AV_PIX_FMT_YUVJ420P}, even_times(8));
  std::string bytes = read_text(path);
  size_t at = 0;
  for (int i = 0; i < 4; ++i) at = bytes.find("\xff\xd8\xff", at + 1);
  const size_t size = bytes.find("\xff\xd9", at) + 2 - at;
  bytes.replace(at, size, size, '\0');
  write_text(path, bytes);
  CHECK_THROWS_WITH(Reading(path), Catch::Contains("frame #3 can't be decoded") &&
                                       Catch::Contains("--skip-unreadable"));
  const Reading reading(path, Unreadable::skip);
  CHECK(reading.sequence.unreadable == std::vector<size_t>{3});
  CHECK(reading.images.size() == 7);
  CHECK(shows(reading.images.at(4), 4));
  const std::vector<int64_t> times = read_video_times({path, {}}, {});
  REQUIRE(times.size() == 8);
  CHECK(times[3] == 300'000'000);
}

TEST_CASE("damage that a decoder conceals is an error") {
  const TemporaryFolder folder;
  const fs::path path = folder / "concealed.ts";
  const auto noise = [](AVFrame& picture, size_t frame) {
    fill_gray(picture, frame);
    cv::Mat plane(kHeight, kWidth, CV_8U, picture.data[0],
                  static_cast<size_t>(picture.linesize[0]));
    cv::theRNG().state = frame + 1;
    cv::randu(plane, 16, 235);
  };
  write_coded(path, {"libx264", AV_PIX_FMT_YUV420P, noise}, even_times(10));
  std::string bytes = read_text(path);
  constexpr size_t kPacket = 188;
  bytes.resize(bytes.size() - 4 * kPacket);
  write_text(path, bytes);
  CHECK_THROWS_WITH(Reading(path), Catch::Contains("can't be decoded"));
  CHECK_FALSE(Reading(path, Unreadable::skip).sequence.unreadable.empty());
}

TEST_CASE("a video that ends before its stated duration is refused") {
  const auto [codec, name] = GENERATE(table<std::string, std::string>(
      {{"mjpeg", "v.avi"}, {"mjpeg", "v.mkv"}, {"libvpx-vp9", "v.webm"}, {"flv", "v.flv"}}));
  CAPTURE(name);
  const TemporaryFolder folder;
  const fs::path path = folder / name;
  write_coded(path, {codec, codec == "mjpeg" ? AV_PIX_FMT_YUVJ420P : AV_PIX_FMT_YUV420P},
              even_times(40));
  CHECK(Reading(path).sequence.frames == 40);
  std::string bytes = read_text(path);
  bytes.resize(bytes.size() / 2);
  write_text(path, bytes);
  CHECK_THROWS_WITH(Reading(path), Catch::Contains("of 4.0 s. It is damaged") &&
                                       Catch::Contains("-fps_mode passthrough"));
  const Reading reading(path, Unreadable::skip);
  CHECK(reading.sequence.frames < 35);
  REQUIRE_FALSE(reading.warnings.said.empty());
  CHECK(has(reading.warnings.said.back(), "ends after"));
}
