// Reading frames from a camera, with simulated captures instead of hardware.
#include <chrono>
#include <thread>

#include <catch2/catch.hpp>
#include <opencv2/core.hpp>
#include <opencv2/videoio/registry.hpp>

#include "sequence/live_source.h"
#include "support.h"

using namespace vpr;
using namespace vpr::test;
namespace fs = std::filesystem;

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

std::vector<std::string> names_of(LiveSource& source, size_t most) {
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
  for (int i = 0; i < 5; ++i) frames.push_back(*camera->next({}));
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
  CHECK(names_of(*part, 10) == std::vector<std::string>{"#2", "#5", "#8"});
  const auto open = follow_camera(std::make_unique<PacedCapture>(100), argument("@0::4"));
  CHECK(names_of(*open, 3) == std::vector<std::string>{"#0", "#4", "#8"});
  const auto next = open->next({});
  CHECK(next->picture->at<uint8_t>(0, 0) == 12);
}

TEST_CASE("a frame of a camera that cannot be decoded is unreadable") {
  const auto camera = follow_camera(std::make_unique<PacedCapture>(100, 1), argument());
  CHECK_FALSE(camera->next({})->is_unreadable);
  CHECK(camera->next({})->is_unreadable);
  CHECK_FALSE(camera->next({})->is_unreadable);
}

TEST_CASE("a wait for a camera ends with a stop, and with an error after a timeout") {
  std::atomic<bool> stop = false;
  Monitor monitor;
  monitor.stop = &stop;
  auto capture = std::make_unique<PacedCapture>(100);
  capture->stop = &stop;
  capture->stop_at = 2;
  const auto camera = follow_camera(std::move(capture), argument());
  CHECK(camera->next(monitor)->name == "#0");
  CHECK(camera->next(monitor)->name == "#1");
  CHECK(error_kind([&] { camera->next(monitor); }) == ErrorKind::interrupted);

  const auto unplugged = follow_camera(std::make_unique<PacedCapture>(2), argument());
  CHECK(names_of(*unplugged, 2).size() == 2);
  CHECK(error_text([&] { unplugged->next({}); }) ==
        "camera: stopped delivering frames after 2 frames");
}

TEST_CASE("a video played by OpenCV is followed like a camera") {
  const std::string path = "walk.avi";
  {
    cv::VideoWriter writer(path, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10, {64, 48});
    REQUIRE(writer.isOpened());
    for (int i = 0; i < 4; ++i) writer.write(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(40 * i)));
  }
  const auto camera =
      follow_camera(std::make_unique<cv::VideoCapture>(path, cv::CAP_FFMPEG), argument());
  for (int i = 0; i < 4; ++i) {
    const auto frame = camera->next({});
    CHECK(std::abs(cv::mean(*frame->picture)[0] - 40 * i) < 3);
  }
  CHECK_THROWS_AS(camera->next({}), Error);
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
