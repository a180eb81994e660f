#include "images/camera.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>

#include "base/counted.h"
#include "base/error.h"
#include "images/codec_scope.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

class Camera : public LiveSource {
 public:
  Camera(std::unique_ptr<cv::VideoCapture> capture, const SequenceArgument& argument)
      : capture_(std::move(capture)), argument_(argument), wanted_(argument.range.first) {}

  std::optional<LiveFrame> next(const Monitor& monitor) override {
    const FrameRange& range = argument_.range;
    if (range.last && wanted_ >= *range.last) return std::nullopt;
    for (; taken_ <= wanted_; ++taken_) grab(monitor);
    LiveFrame frame{fmt::format("#{}", wanted_), argument_.path, retrieve(), false};
    frame.is_unreadable = frame.picture->empty();
    wanted_ += range.step;
    return frame;
  }

 private:
  // A signal ends it without a frame.
  void grab(const Monitor& monitor) {
    check_stop(monitor);
    const bool has_frame = capture_->grab();
    check_stop(monitor);
    if (!has_frame)
      throw Error(ErrorKind::input, fmt::format("{}: gives no frame any more, after {}",
                                                argument_.path.string(), counted(taken_, "frame")));
  }

  std::shared_ptr<const cv::Mat> retrieve() {
    const CodecScope scope(argument_.path);
    cv::Mat image;
    if (!capture_->retrieve(image)) image.release();
    return std::make_shared<const cv::Mat>(image.clone());  // the next frame takes its memory
  }

  std::unique_ptr<cv::VideoCapture> capture_;
  SequenceArgument argument_;
  uint64_t wanted_;
  uint64_t taken_ = 0;
};

bool opens(cv::VideoCapture& capture, const fs::path& path) {
  try {
    const CodecScope scope(path);
    return capture.open(path.string(), cv::CAP_V4L2);
  } catch (const cv::Exception&) {
    return false;
  }
}

}  // namespace

bool is_device(const fs::path& path) {
  std::error_code ignored;
  return fs::is_character_file(path, ignored);
}

std::unique_ptr<LiveSource> open_camera(const SequenceArgument& argument) {
  auto capture = std::make_unique<cv::VideoCapture>();
  if (!opens(*capture, argument.path))
    throw Error(ErrorKind::input,
                fmt::format("{}: is a device that can't be opened as a camera: it is none, is in "
                            "use, or you may not read it",
                            argument.path.string()));
  const auto property = [&](int name) {
    return static_cast<uint64_t>(std::max(0.0, capture->get(name)));
  };
  check_frame_size(argument.path, property(cv::CAP_PROP_FRAME_WIDTH),
                   property(cv::CAP_PROP_FRAME_HEIGHT));
  return follow_camera(std::move(capture), argument);
}

std::unique_ptr<LiveSource> follow_camera(std::unique_ptr<cv::VideoCapture> capture,
                                          const SequenceArgument& argument) {
  return std::make_unique<Camera>(std::move(capture), argument);
}

}  // namespace vpr
