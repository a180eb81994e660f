// Live frames: from a camera, with simulated captures instead of hardware, a folder, and a pipe.
#include "recordings/live_source.h"

#include <array>
#include <chrono>
#include <thread>

#include <catch2/catch.hpp>
#include <opencv2/core.hpp>
#include <opencv2/videoio/registry.hpp>
#include <unistd.h>

#include "support.h"

using namespace vpr;
using namespace vpr::test;

namespace {

constexpr auto kPace = std::chrono::milliseconds(2);

/// Returns frames of a single gray level, frame n with level n, at a constant rate and in the same
/// memory, as a driver does. Requests a stop at frame `stop_at` if `stop` is set.
class PacedCapture : public cv::VideoCapture {
 public:
  explicit PacedCapture(int frames, int broken = -1) : frames_(frames), broken_(broken) {}

  bool grab() override {
    std::this_thread::sleep_for(kPace);
    if (stop != nullptr && grabbed_ + 1 == stop_at) {
      stop->store(true);
      return false;  // like a wait interrupted by a signal
    }
    return ++grabbed_ < frames_;
  }
  bool retrieve(cv::OutputArray image, int) override {
    if (grabbed_ == broken_) return false;
    memory_.setTo(grabbed_);
    image.assign(memory_);
    return true;
  }

  std::atomic<bool>* stop = nullptr;
  int stop_at = -1;

 private:
  int frames_;
  int broken_;
  int grabbed_ = -1;
  cv::Mat memory_ = cv::Mat(3, 4, CV_8UC1, cv::Scalar(0));
};

SequenceArgument argument(const std::string& range = "") {
  return parse_sequence_argument("camera" + range);
}

std::vector<std::string> names_of(const LiveSource& source, size_t most) {
  std::vector<std::string> names;
  while (names.size() < most) {
    const auto frame = source.next({});
    if (!frame) break;
    names.push_back(frame->name);
  }
  return names;
}

}  // namespace

TEST_CASE("frames of a camera arrive one by one and keep their images") {
  const auto camera = follow_camera(std::make_unique<PacedCapture>(100), argument());
  std::vector<LiveFrame> frames;
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 5; ++i) frames.push_back(*camera.next({}));
  CHECK(std::chrono::steady_clock::now() - begin >= 5 * kPace);
  for (int i = 0; i < 5; ++i) {
    const LiveFrame& frame = frames[static_cast<size_t>(i)];
    CHECK(frame.name == "#" + std::to_string(i));
    CHECK_FALSE(frame.is_unreadable);
    CHECK(frame.picture->at<uint8_t>(2, 3) == i);
  }
}

TEST_CASE("a range of a camera selects frames and ends the stream") {
  const auto part = follow_camera(std::make_unique<PacedCapture>(100), argument("@2:9:3"));
  CHECK(names_of(part, 10) == std::vector<std::string>{"#2", "#5", "#8"});
  const auto open = follow_camera(std::make_unique<PacedCapture>(100), argument("@0::4"));
  CHECK(names_of(open, 3) == std::vector<std::string>{"#0", "#4", "#8"});
  const auto next = open.next({});
  CHECK(next->picture->at<uint8_t>(0, 0) == 12);
}

TEST_CASE("a frame of a camera that cannot be decoded is unreadable") {
  const auto camera = follow_camera(std::make_unique<PacedCapture>(100, 1), argument());
  CHECK_FALSE(camera.next({})->is_unreadable);
  CHECK(camera.next({})->is_unreadable);
  CHECK_FALSE(camera.next({})->is_unreadable);
}

TEST_CASE("a wait for a camera ends with a stop, and with an error after a timeout") {
  std::atomic<bool> stop = false;
  Monitor monitor;
  monitor.stop = &stop;
  auto capture = std::make_unique<PacedCapture>(100);
  capture->stop = &stop;
  capture->stop_at = 2;
  const auto camera = follow_camera(std::move(capture), argument());
  CHECK(camera.next(monitor)->name == "#0");
  CHECK(camera.next(monitor)->name == "#1");
  CHECK(error_kind([&] { camera.next(monitor); }) == ErrorKind::interrupted);

  const auto unplugged = follow_camera(std::make_unique<PacedCapture>(2), argument());
  CHECK(names_of(unplugged, 2).size() == 2);
  CHECK(error_text([&] { unplugged.next({}); }) ==
        "camera: stopped delivering frames after 2 frames");
}

TEST_CASE("a video played by OpenCV is followed like a camera") {
  const std::string path = "walk.avi";
  write_video(path, 64, 48, {0, 40, 80, 120});
  const auto camera =
      follow_camera(std::make_unique<cv::VideoCapture>(path, cv::CAP_FFMPEG), argument());
  for (int i = 0; i < 4; ++i) {
    const auto frame = camera.next({});
    CHECK(std::abs(cv::mean(*frame->picture)[0] - 40 * i) < 3);
  }
  CHECK_THROWS_AS(camera.next({}), Error);
}

TEST_CASE("a device that is not a camera is refused with a sentence") {
  const auto open = [] {
    open_live_source(parse_sequence_argument("/dev/null"), Unreadable::fail);
  };
  CHECK(error_kind(open) == ErrorKind::input);
  CHECK(error_text(open).starts_with("/dev/null: is a device that can't be opened"));
  // the device's name selects the backend
  const auto backends = cv::videoio_registry::getStreamBackends();
  CHECK(std::find(backends.begin(), backends.end(), cv::CAP_V4L2) != backends.end());
}

TEST_CASE("a folder is read to its end") {
  const TemporaryFolder folder;
  for (const char* name : {"10.png", "9.png", ".hidden.png"}) write_image(folder / name, 1);
  write_text(folder / "notes.txt", "x");
  CHECK(names_of(open_live_source({folder.path(), {}}, Unreadable::fail), 9) ==
        std::vector<std::string>{"9.png", "10.png"});
  CHECK(names_of(open_live_source({folder.path(), {1, std::nullopt}}, Unreadable::fail), 9) ==
        std::vector<std::string>{"10.png"});
  CHECK(open_live_source({folder.path(), {}}, Unreadable::fail).next({})->may_be_gone);
}

TEST_CASE("a pipe has the images of its lines, and one warning for other names") {
  std::array<int, 2> ends;
  REQUIRE(::pipe(ends.data()) == 0);
  const std::string lines =
      "\xEF\xBB\xBF"
      "a/1.png\n\n# a note\n.part.png\nnotes\n0.png.tmp\r\nb/0.JPG\r\n2.png";
  REQUIRE(::write(ends[1], lines.data(), lines.size()) == ssize_t(lines.size()));
  ::close(ends[1]);
  const LiveSource pipe = open_live_pipe(ends[0]);
  Warnings warnings;
  std::vector<std::string> files;
  while (const auto frame = pipe.next(warnings.monitor)) {
    CHECK(frame->may_be_gone);
    files.push_back(frame->file.string());
  }
  ::close(ends[0]);
  CHECK(files == std::vector<std::string>{"a/1.png", "b/0.JPG", "2.png"});
  CHECK(warnings.said ==
        std::vector<std::string>{"notes: is not the name of an image. Such lines are ignored"});
}
