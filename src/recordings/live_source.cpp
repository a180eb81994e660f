#include "recordings/live_source.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>
#include <poll.h>
#include <unistd.h>

#include "base/error.h"
#include "base/output.h"
#include "base/text.h"
#include "recordings/decode.h"
#include "recordings/sequence_source.h"
#include "recordings/video.h"

namespace vpr {

namespace {

namespace fs = std::filesystem;

constexpr int kMaxDelayMs = 50;  // maximum delay of a stop

bool open_camera(cv::VideoCapture& capture, const fs::path& path) {
  try {
    const CodecScope scope(path);
    if (!capture.open(path.string(), cv::CAP_V4L2)) return false;
  } catch (const cv::Exception&) {
    return false;
  }
  const auto size = [&](int property) {
    return static_cast<uint64_t>(std::max(0.0, capture.get(property)));
  };
  check_frame_size(path, size(cv::CAP_PROP_FRAME_WIDTH), size(cv::CAP_PROP_FRAME_HEIGHT));
  return true;
}

LiveFrame image_of(const fs::path& file) {
  return {file.filename().string(), file, nullptr, false};
}

class LinePipe {
 public:
  explicit LinePipe(int descriptor) : descriptor_(descriptor) {}
  std::optional<LiveFrame> next(const Monitor& monitor) {
    for (;;) {
      check_stop(monitor);
      while (const auto line = take_line()) {
        if (line->empty() || line->starts_with('#')) continue;
        if (line->find('\0') != std::string::npos)
          throw Error(ErrorKind::input, "standard input: does not have one image path per line");
        if (is_frame_name(*line)) {
          LiveFrame frame = image_of(*line);
          frame.may_be_gone = true;
          return frame;
        }
        if (!fs::path(*line).filename().string().starts_with('.') &&
            !std::exchange(warned_of_name_, true))
          warn(monitor, "{}: is not the name of an image. Such lines are ignored", *line);
      }
      if (ended_) return std::nullopt;
      read_more();
    }
  }

 private:
  // The last line may have no line feed.
  std::optional<std::string> take_line() {
    const size_t end = text_.find('\n');
    if (end == std::string::npos && (!ended_ || text_.empty())) return std::nullopt;
    std::string line(is_first_line_ ? without_byte_order_mark(text_.substr(0, end))
                                    : text_.substr(0, end));
    is_first_line_ = false;
    text_.erase(0, end == std::string::npos ? end : end + 1);
    if (line.ends_with('\r')) line.pop_back();
    return line;
  }

  void read_more() {
    pollfd input{descriptor_, POLLIN, 0};
    if (::poll(&input, 1, kMaxDelayMs) <= 0) return;
    std::array<char, 4096> buffer;
    const ssize_t bytes = ::read(descriptor_, buffer.data(), buffer.size());
    if (bytes > 0) text_.append(buffer.data(), static_cast<size_t>(bytes));
    if (bytes == 0) ended_ = true;
    if (bytes < 0 && errno != EINTR && errno != EAGAIN)
      throw Error(ErrorKind::input, "standard input: can't be read: {}", system_error_text(errno));
  }

  int descriptor_;
  std::string text_;
  bool is_first_line_ = true;
  bool ended_ = false;
  bool warned_of_name_ = false;
};

}  // namespace

bool LiveFrame::is_gone() const {
  std::error_code ignored;
  return may_be_gone && !fs::exists(file, ignored);
}

SequenceSource LiveFrame::sequence() const {
  if (array) {
    SequenceArgument descriptor{name.empty() ? "frame" : name, {}};
    descriptor.array = array;
    return open_sequence(descriptor);
  }
  return {{file, {}}, SequenceKind::images, {file}, picture.get()};
}

LiveSource open_live_source(const SequenceArgument& argument, Unreadable unreadable) {
  if (is_camera(argument.path)) {
    auto capture = std::make_unique<cv::VideoCapture>();
    if (!open_camera(*capture, argument.path))
      throw Error(ErrorKind::input,
                  "{}: is a device that can't be opened as a camera: it is not a camera, is in "
                  "use, or is not readable",
                  argument.path.string());
    return follow_camera(std::move(capture), argument);
  }
  const SequenceSource sequence = open_sequence(argument);
  if (sequence.kind == SequenceKind::video) {
    const auto reader = std::make_shared<VideoReader>(argument, PixelFormat::bgr, unreadable);
    return {[=](const Monitor& monitor) -> std::optional<LiveFrame> {
      check_stop(monitor);
      IndexedFrame frame;
      if (!reader->next(frame, monitor)) {
        reader->finish(monitor);
        return std::nullopt;
      }
      const bool is_unreadable = frame.image.empty();
      return LiveFrame{fmt::format("#{}", frame.recorded), argument.path,
                       std::make_shared<const cv::Mat>(std::move(frame.image)), is_unreadable};
    }};
  }
  std::error_code ignored;
  return {[files = sequence.files, is_folder = fs::is_directory(argument.path, ignored),
           index = size_t{0}](const Monitor& monitor) mutable -> std::optional<LiveFrame> {
    check_stop(monitor);
    if (index == files.size()) return std::nullopt;
    LiveFrame frame = image_of(files[index++]);
    frame.may_be_gone = is_folder;
    return frame;
  }};
}

LiveSource open_live_pipe(int descriptor) {
  return {
      [pipe = LinePipe(descriptor)](const Monitor& monitor) mutable { return pipe.next(monitor); }};
}

LiveSource follow_camera(std::unique_ptr<cv::VideoCapture> capture,
                         const SequenceArgument& argument) {
  return {[capture = std::shared_ptr(std::move(capture)), argument, wanted = argument.range.first,
           taken = uint64_t{0}](const Monitor& monitor) mutable -> std::optional<LiveFrame> {
    if (argument.range.last && wanted >= *argument.range.last) return std::nullopt;
    for (; taken <= wanted; ++taken) {
      check_stop(monitor);
      const bool has_frame = capture->grab();  // a signal ends the wait without a frame
      check_stop(monitor);
      if (!has_frame)
        throw Error(ErrorKind::input, "{}: stopped delivering frames after {}",
                    argument.path.string(), counted(taken, "frame"));
    }
    const CodecScope scope(argument.path);
    cv::Mat image;
    if (!capture->retrieve(image)) image.release();
    const std::string name = fmt::format("#{}", wanted);
    wanted += argument.range.step;
    // The next frame reuses the memory of the image.
    return LiveFrame{name, argument.path, std::make_shared<const cv::Mat>(image.clone()),
                     image.empty()};
  }};
}

}  // namespace vpr
