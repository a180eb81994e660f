#include "sequence/live_source.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>
#include <poll.h>
#include <sys/inotify.h>
#include <unistd.h>

#include "base/error.h"
#include "base/text.h"
#include "sequence/decode.h"
#include "sequence/sequence_source.h"
#include "sequence/video_reader.h"

namespace vpr {

namespace {

namespace fs = std::filesystem;

constexpr int kPatienceMs = 50;  // maximum delay of a stop

LiveFrame image_of(const fs::path& file) {
  return {file.filename().string(), file, nullptr, false};
}

class LiveFolder : public LiveSource {
 public:
  explicit LiveFolder(const fs::path& folder) : folder_(folder) {}
  std::optional<LiveFrame> next(const Monitor& monitor) override {
    return image_of(folder_.next(monitor));
  }

 private:
  GrowingFolder folder_;
};

class LiveList : public LiveSource {
 public:
  explicit LiveList(std::vector<fs::path> files) : files_(std::move(files)) {}
  std::optional<LiveFrame> next(const Monitor& monitor) override {
    check_stop(monitor);
    if (next_ == files_.size()) return std::nullopt;
    return image_of(files_[next_++]);
  }

 private:
  std::vector<fs::path> files_;
  size_t next_ = 0;
};

class LiveVideo : public LiveSource {
 public:
  LiveVideo(const SequenceArgument& argument, Unreadable unreadable)
      : file_(argument.path), unreadable_(unreadable), reader_(argument, PixelFormat::bgr) {}
  std::optional<LiveFrame> next(const Monitor& monitor) override {
    check_stop(monitor);
    IndexedFrame frame;
    if (!reader_.next(frame, monitor)) {
      reader_.finish(unreadable_, monitor);
      return std::nullopt;
    }
    const bool is_unreadable = frame.image.empty();
    return LiveFrame{fmt::format("#{}", frame.recorded), file_,
                     std::make_shared<const cv::Mat>(std::move(frame.image)), is_unreadable};
  }

 private:
  fs::path file_;
  Unreadable unreadable_;
  VideoReader reader_;
};

class LivePipe : public LiveSource {
 public:
  explicit LivePipe(int descriptor) : descriptor_(descriptor) {}
  std::optional<LiveFrame> next(const Monitor& monitor) override {
    for (;;) {
      check_stop(monitor);
      while (const auto line = take_line()) {
        if (line->empty() || line->starts_with('#')) continue;
        if (line->find('\0') != std::string::npos)
          throw Error(ErrorKind::input, "standard input: is not one image path a line");
        return image_of(*line);
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
    if (::poll(&input, 1, kPatienceMs) <= 0) return;
    std::array<char, 4096> buffer;
    const ssize_t bytes = ::read(descriptor_, buffer.data(), buffer.size());
    if (bytes > 0) text_.append(buffer.data(), static_cast<size_t>(bytes));
    if (bytes == 0) ended_ = true;
    if (bytes < 0 && errno != EINTR && errno != EAGAIN)
      throw Error(ErrorKind::input,
                  fmt::format("standard input: can't be read: {}", system_error_text(errno)));
  }

  int descriptor_;
  std::string text_;
  bool is_first_line_ = true;
  bool ended_ = false;
};

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
  // A signal ends the wait without a frame.
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
    return std::make_shared<const cv::Mat>(image.clone());  // the next frame reuses its memory
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

constexpr std::chrono::seconds kLookEvery(1);  // for folders without events

Error gone(const fs::path& folder, const std::string& why) {
  return {ErrorKind::input, fmt::format("{}: can't be read: {}", folder.string(), why)};
}

}  // namespace

SequenceSource LiveFrame::sequence() const {
  return {{file, {}}, SequenceKind::images, {file}, picture.get()};
}

std::unique_ptr<LiveSource> open_live_source(const SequenceArgument& argument,
                                             Unreadable unreadable) {
  std::error_code error;
  if (fs::is_directory(argument.path, error)) {
    if (!argument.range.is_all())
      throw Error(ErrorKind::usage,
                  fmt::format("{}: a folder that grows has no range; leave {} out",
                              argument.path.string(), range_text(argument.range)));
    return std::make_unique<LiveFolder>(argument.path);
  }
  if (is_device(argument.path)) return open_camera(argument);
  SequenceSource sequence = open_sequence(argument);
  if (sequence.kind == SequenceKind::video)
    return std::make_unique<LiveVideo>(argument, unreadable);
  return std::make_unique<LiveList>(std::move(sequence.files));
}

std::unique_ptr<LiveSource> open_live_pipe(int descriptor) {
  return std::make_unique<LivePipe>(descriptor);
}

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

GrowingFolder::GrowingFolder(const fs::path& folder, std::chrono::milliseconds rest)
    : folder_(folder), rest_for_(rest), changed_(fs::file_time_type::min()) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw gone(folder, "is no folder");
  // Before the folder is read for the first time, so that no file is missed in between.
  events_ = ::inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
  if (events_ < 0) return;
  if (::inotify_add_watch(events_, folder.c_str(), IN_CLOSE_WRITE | IN_MOVED_TO | IN_CREATE) < 0) {
    ::close(events_);
    events_ = -1;
  }
}

GrowingFolder::~GrowingFolder() {
  if (events_ >= 0) ::close(events_);
}

void GrowingFolder::look() {
  const Clock::time_point now = Clock::now();
  if (looked_ && now - *looked_ < kLookEvery) return;
  looked_ = now;
  std::error_code error;
  const fs::file_time_type changed = fs::last_write_time(folder_, error);
  if (error) throw gone(folder_, error.message());
  if (changed == changed_) return;
  changed_ = changed;
  for (fs::directory_iterator it(folder_, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (is_frame_name(name) && is_later(name)) waiting_.insert(name);
  }
  if (error) throw gone(folder_, error.message());
}

bool GrowingFolder::is_later(const std::string& name) const {
  return last_.empty() || natural_less(last_, name);
}

void GrowingFolder::take_event(const std::string& name, uint32_t event, const Monitor& monitor) {
  if (!is_frame_name(name)) return;
  if (is_later(name)) {
    waiting_.insert(name);
    if ((event & IN_MOVED_TO) != 0) renamed_.insert(name);
    if ((event & IN_CLOSE_WRITE) != 0) closed_.insert(name);
  } else if (natural_less(name, last_) && (event & IN_CLOSE_WRITE) == 0) {
    warn(monitor, fmt::format("{}: came after {}, which was taken before, and is left out",
                              (folder_ / name).string(), last_));
  }
}

void GrowingFolder::read_events(const Monitor& monitor) {
  alignas(inotify_event) std::array<char, 16384> buffer;
  while (events_ >= 0) {
    const ssize_t bytes = ::read(events_, buffer.data(), buffer.size());
    if (bytes <= 0) return;
    for (ssize_t at = 0; at < bytes;) {
      inotify_event event;
      std::memcpy(&event, buffer.data() + at, sizeof(event));
      at += static_cast<ssize_t>(sizeof(event));
      if (event.len > 0) take_event(buffer.data() + at, event.mask, monitor);
      at += event.len;
    }
  }
}

bool GrowingFolder::has_rested(const std::string& name) {
  std::error_code error;
  const uintmax_t size = fs::file_size(folder_ / name, error);
  const Clock::time_point now = Clock::now();
  if (error) {  // it no longer exists
    waiting_.erase(name);
    resting_.reset();
    return false;
  }
  if (!resting_ || resting_->name != name || resting_->size != size) resting_ = {name, size, now};
  return size > 0 && now - resting_->since >= rest_for_;
}

bool GrowingFolder::can_be_decoded(const std::string& name, const Monitor& monitor) {
  try {
    decode_image(folder_ / name, PixelFormat::gray);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) return true;
    closed_.erase(name);
    resting_.reset();
    if (std::exchange(incomplete_, name) != name)
      warn(monitor, fmt::format("{}: is incomplete; waiting for the rest of it, or a later image",
                                (folder_ / name).string()));
    return false;
  }
  return true;
}

bool GrowingFolder::is_complete(const std::string& name, const Monitor& monitor) {
  if (renamed_.contains(name) || waiting_.size() > 1) return true;
  return (closed_.contains(name) || has_rested(name)) && can_be_decoded(name, monitor);
}

void GrowingFolder::wait() const {
  pollfd events{events_, POLLIN, 0};  // poll ignores a negative descriptor
  ::poll(&events, 1, kPatienceMs);
}

fs::path GrowingFolder::next(const Monitor& monitor) {
  for (;; wait()) {
    check_stop(monitor);
    read_events(monitor);
    look();
    if (waiting_.empty()) continue;
    const std::string name = *waiting_.begin();
    if (!is_complete(name, monitor)) continue;
    waiting_.erase(name);
    renamed_.erase(name);
    closed_.erase(name);
    last_ = name;
    return folder_ / name;
  }
}

}  // namespace vpr
