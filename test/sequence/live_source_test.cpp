// Live frames: from a camera, with simulated captures instead of hardware, and a growing folder.
#include "sequence/live_source.h"

#include <chrono>
#include <fstream>
#include <future>
#include <thread>

#include <catch2/catch.hpp>
#include <opencv2/core.hpp>
#include <opencv2/videoio/registry.hpp>

#include "support.h"

using namespace vpr;
using namespace vpr::test;
using namespace std::chrono_literals;
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

// The bytes of an image; the hidden file that it writes is not a frame.
std::string image_bytes(const TemporaryFolder& folder) {
  write_image(folder / ".whole.png", 1);
  return read_text(folder / ".whole.png");
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

// Writes a file under another name and renames it, as other programs do.
void put(const fs::path& folder, const std::string& name) {
  write_image(folder / ".part.png", 1);
  fs::rename(folder / ".part.png", folder / name);
}

fs::path next_file(const LiveSource& source, const Monitor& monitor = {}) {
  return source.next(monitor)->file;
}

std::future<fs::path> next_of(const LiveSource& folder) {
  return std::async(std::launch::async, [&] { return next_file(folder); });
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

TEST_CASE("images arrive in natural order, as soon as they are renamed into a folder") {
  const TemporaryFolder folder;
  put(folder.path(), "10.png");
  put(folder.path(), "9.png");
  put(folder.path(), "notes.txt");
  put(folder.path(), ".hidden.png");
  const LiveSource growing = follow_folder(folder.path(), 20ms);
  CHECK(next_file(growing) == folder / "9.png");  // it existed, and has not changed
  CHECK(next_file(growing) == folder / "10.png");
  put(folder.path(), "11.png");
  CHECK(next_file(growing) == folder / "11.png");  // renamed: returned at once
  for (int i = 12; i < 40; ++i) {
    auto next = next_of(growing);
    put(folder.path(), std::to_string(i) + ".png");
    CHECK(next.get() == folder / (std::to_string(i) + ".png"));
  }
}

TEST_CASE("decimal names in a growing folder have the order of folders") {
  const TemporaryFolder folder;
  for (const char* name : {"1.5.png", "1.png", "0.5.png"}) put(folder.path(), name);
  const LiveSource growing = follow_folder(folder.path(), 0ms);
  for (const char* name : {"0.5.png", "1.png", "1.5.png", "2.png", "2.25.png", "10.png"}) {
    if (!fs::exists(folder / name)) put(folder.path(), name);
    CHECK(next_file(growing) == folder / name);
  }
  const TemporaryFolder unclear;
  for (const char* name : {"1.9.png", "1.10.png", "2.05.png"}) put(unclear.path(), name);
  CHECK(has(error_text([&] { next_file(follow_folder(unclear.path())); }), "--order natural"));
}

TEST_CASE("an unfinished file is awaited") {
  const TemporaryFolder folder;
  const LiveSource growing = follow_folder(folder.path(), 1h);
  const std::string image = image_bytes(folder);
  std::ofstream file(folder / "1.png", std::ios::binary);
  file << image.substr(0, 50) << std::flush;
  auto next = std::async(std::launch::async, [&] { return fs::file_size(next_file(growing)); });
  file << image.substr(50) << std::flush;
  file.close();
  CHECK(next.get() == image.size());
}

TEST_CASE("an image whose writer pauses is awaited, and a warning names it once") {
  const TemporaryFolder folder;
  const std::string image = image_bytes(folder);
  const bool is_closed = GENERATE(false, true);  // between the parts
  const LiveSource growing = follow_folder(folder.path(), 0ms);
  std::ofstream file(folder / "1.png", std::ios::binary);
  file << image.substr(0, 50) << std::flush;
  if (is_closed) file.close();
  std::promise<void> was_incomplete;
  int warnings = 0;
  Monitor monitor;
  monitor.warn = [&](const std::string& sentence) {
    CHECK(has(sentence, "1.png: is incomplete"));
    if (warnings++ == 0) was_incomplete.set_value();
  };
  auto next =
      std::async(std::launch::async, [&] { return fs::file_size(next_file(growing, monitor)); });
  was_incomplete.get_future().wait();
  if (is_closed) file.open(folder / "1.png", std::ios::binary | std::ios::app);
  file << image.substr(50) << std::flush;
  file.close();
  CHECK(next.get() == image.size());
  CHECK(warnings == 1);
}

TEST_CASE("later images wait for an incomplete one, for a bounded time") {
  const TemporaryFolder folder;
  const LiveSource growing = follow_folder(folder.path(), 50ms);
  const std::string image = image_bytes(folder);
  std::ofstream file(folder / "1.png", std::ios::binary);
  file << image.substr(0, 50) << std::flush;
  put(folder.path(), "2.png");
  auto next = next_of(growing);
  CHECK(next.wait_for(150ms) == std::future_status::timeout);
  file << image.substr(50) << std::flush;
  file.close();
  CHECK(next.get() == folder / "1.png");
  CHECK(next_file(growing) == folder / "2.png");
  write_text(folder / "3.png", "x");  // never complete
  put(folder.path(), "4.png");
  CHECK(next_file(growing) == folder / "3.png");
  CHECK(next_file(growing) == folder / "4.png");
}

TEST_CASE("a broken image with a late name does not make earlier ones be used too soon") {
  const TemporaryFolder folder;
  write_text(folder / "9999.png", "x");
  const LiveSource growing = follow_folder(folder.path(), 20ms);
  put(folder.path(), "1.png");
  CHECK(next_file(growing) == folder / "1.png");
  auto next = next_of(growing);
  CHECK(next.wait_for(300ms) == std::future_status::timeout);
  put(folder.path(), "2.png");
  CHECK(next.get() == folder / "2.png");
}

TEST_CASE("an existing file is returned when its size is stable, an open one when it is closed") {
  const TemporaryFolder folder;
  write_image(folder / "1.png", 1);
  const LiveSource growing = follow_folder(folder.path(), 0ms);
  CHECK(next_file(growing) == folder / "1.png");
  std::ofstream file(folder / "2.png", std::ios::binary);
  file << read_text(folder / "1.png") << std::flush;
  auto next = next_of(growing);
  CHECK(next.wait_for(100ms) == std::future_status::timeout);
  file.close();
  CHECK(next.get() == folder / "2.png");
}

TEST_CASE("an image that arrives too late is omitted with a warning") {
  const TemporaryFolder folder;
  const LiveSource growing = follow_folder(folder.path(), 1h);
  put(folder.path(), "5.png");
  CHECK(next_file(growing) == folder / "5.png");
  put(folder.path(), "3.png");
  put(folder.path(), "6.png");
  Monitor monitor;
  std::string said;
  monitor.warn = [&](const std::string& sentence) { said += sentence; };
  CHECK(next_file(growing, monitor) == folder / "6.png");
  CHECK(has(said, "3.png: arrived after 5.png"));
}

TEST_CASE("waiting ends on a stop and when the folder is removed") {
  fs::create_directory("f");
  const LiveSource growing = follow_folder("f", 1h);
  std::atomic<bool> stop = true;
  Monitor monitor;
  monitor.stop = &stop;
  CHECK(error_kind([&] { next_file(growing, monitor); }) == ErrorKind::interrupted);
  fs::remove("f");
  CHECK(error_kind([&] { next_file(growing); }) == ErrorKind::input);
  CHECK(error_kind([&] { follow_folder("f"); }) == ErrorKind::input);
}
