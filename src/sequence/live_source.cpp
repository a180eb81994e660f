#include "sequence/live_source.h"

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
#include "sequence/decode.h"
#include "sequence/sequence_source.h"

namespace vpr {

namespace {

namespace fs = std::filesystem;

constexpr int kMaxDelayMs = 50;  // maximum delay of a stop

LiveFrame image_of(const fs::path& file) {
  return {file.filename().string(), file, nullptr, false};
}

std::unique_ptr<LiveSource> live_source(
    std::function<std::optional<LiveFrame>(const Monitor&)> next) {
  return std::make_unique<LiveSource>(LiveSource{std::move(next)});
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
};

class Camera {
 public:
  Camera(std::unique_ptr<cv::VideoCapture> capture, const SequenceArgument& argument)
      : capture_(std::move(capture)), argument_(argument), wanted_(argument.range.first) {}

  std::optional<LiveFrame> next(const Monitor& monitor) {
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
      throw Error(ErrorKind::input, "{}: stopped delivering frames after {}",
                  argument_.path.string(), counted(taken_, "frame"));
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

constexpr std::chrono::seconds kReadEvery(1);  // for folders without events
constexpr int kPatience = 10;  // times the rest, for which later images wait for an incomplete one

Error gone(const fs::path& folder, const std::string& why) {
  return {ErrorKind::input, fmt::format("{}: can't be read: {}", folder.string(), why)};
}

}  // namespace

SequenceSource LiveFrame::sequence() const {
  if (array) {
    SequenceArgument descriptor{name, {}};
    descriptor.array = array;
    return open_sequence(descriptor);
  }
  return {{file, {}}, SequenceKind::images, {file}, picture.get()};
}

std::unique_ptr<LiveSource> open_live_source(const SequenceArgument& argument,
                                             Unreadable unreadable) {
  std::error_code error;
  if (fs::is_directory(argument.path, error)) {
    if (!argument.range.is_all())
      throw Error(ErrorKind::usage, "{}: a growing folder cannot have a range. Remove {}",
                  argument.path.string(), range_text(argument.range));
    const auto folder = std::make_shared<GrowingFolder>(argument.path);
    return live_source([=](const Monitor& monitor) { return image_of(folder->next(monitor)); });
  }
  if (fs::is_character_file(argument.path, error)) {
    auto capture = std::make_unique<cv::VideoCapture>();
    if (!open_capture(*capture, argument.path, cv::CAP_V4L2))
      throw Error(ErrorKind::input,
                  "{}: is a device that can't be opened as a camera: it is not a camera, is in "
                  "use, or is not readable",
                  argument.path.string());
    return follow_camera(std::move(capture), argument);
  }
  const SequenceSource sequence = open_sequence(argument);
  if (sequence.kind == SequenceKind::video) {
    const auto reader = std::make_shared<VideoReader>(argument, PixelFormat::bgr);
    return live_source([=](const Monitor& monitor) -> std::optional<LiveFrame> {
      check_stop(monitor);
      IndexedFrame frame;
      if (!reader->next(frame, monitor)) {
        reader->finish(unreadable, monitor);
        return std::nullopt;
      }
      const bool is_unreadable = frame.image.empty();
      return LiveFrame{fmt::format("#{}", frame.recorded), argument.path,
                       std::make_shared<const cv::Mat>(std::move(frame.image)), is_unreadable};
    });
  }
  return live_source([files = sequence.files, index = size_t{0}](
                         const Monitor& monitor) mutable -> std::optional<LiveFrame> {
    check_stop(monitor);
    if (index == files.size()) return std::nullopt;
    return image_of(files[index++]);
  });
}

std::unique_ptr<LiveSource> open_live_pipe(int descriptor) {
  return live_source(
      [pipe = LinePipe(descriptor)](const Monitor& monitor) mutable { return pipe.next(monitor); });
}

std::unique_ptr<LiveSource> follow_camera(std::unique_ptr<cv::VideoCapture> capture,
                                          const SequenceArgument& argument) {
  const auto camera = std::make_shared<Camera>(std::move(capture), argument);
  return live_source([=](const Monitor& monitor) { return camera->next(monitor); });
}

GrowingFolder::GrowingFolder(const fs::path& folder, std::chrono::milliseconds rest)
    : folder_(folder), rest_for_(rest), changed_(fs::file_time_type::min()) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) throw gone(folder, "it is not a folder");
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

void GrowingFolder::read_folder() {
  const Clock::time_point now = Clock::now();
  if (read_at_ && now - *read_at_ < kReadEvery) return;
  read_at_ = now;
  std::error_code error;
  const fs::file_time_type changed = fs::last_write_time(folder_, error);
  if (error) throw gone(folder_, error.message());
  if (changed == changed_) return;
  changed_ = changed;
  for (fs::directory_iterator it(folder_, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename().string();
    if (is_frame_name(name) && is_later(name)) pending_.insert(name);
  }
  if (error) throw gone(folder_, error.message());
}

bool GrowingFolder::is_later(const std::string& name) const {
  return last_.empty() || frame_name_less(last_, name);
}

void GrowingFolder::handle_event(const std::string& name, uint32_t event, const Monitor& monitor) {
  if (!is_frame_name(name)) return;
  if (is_later(name)) {
    pending_.insert(name);
    if ((event & IN_MOVED_TO) != 0) renamed_.insert(name);
    if ((event & IN_CLOSE_WRITE) != 0) {
      closed_.insert(name);
      refused_.reset();
    }
  } else if (frame_name_less(name, last_) && (event & IN_CLOSE_WRITE) == 0) {
    warn(monitor, "{}: arrived after {}, which was already used, and is omitted",
         (folder_ / name).string(), last_);
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
      if (event.len > 0) handle_event(buffer.data() + at, event.mask, monitor);
      at += event.len;
    }
  }
}

void GrowingFolder::observe(const std::string& name) {
  std::error_code error;
  const uintmax_t size = fs::file_size(folder_ / name, error);
  if (error) {  // it no longer exists
    pending_.erase(name);
    resting_.reset();
  } else if (!resting_ || resting_->name != name || resting_->size != size) {
    resting_ = {name, size, Clock::now()};
  }
}

bool GrowingFolder::has_rested(const std::string& name, Clock::duration time) const {
  std::error_code error;
  const fs::file_time_type written = fs::last_write_time(folder_ / name, error);
  if (error || resting_->size == 0) return false;
  return Clock::now() - resting_->since >= time ||
         fs::file_time_type::clock::now() - written >= time;
}

bool GrowingFolder::can_be_decoded(const std::string& name, const Monitor& monitor) {
  if (refused_ && refused_->name == name && refused_->size == resting_->size) return false;
  try {
    decode_image(folder_ / name, PixelFormat::gray);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::input) return true;
    refused_ = resting_;
    if (std::exchange(incomplete_, name) != name)
      warn(monitor, "{}: is incomplete. Later images wait for it", (folder_ / name).string());
    return false;
  }
  return true;
}

bool GrowingFolder::is_complete(const std::string& name, const Monitor& monitor) {
  if (renamed_.contains(name)) return true;
  observe(name);
  if (!resting_) return false;
  if ((closed_.contains(name) || has_rested(name, rest_for_)) && can_be_decoded(name, monitor))
    return true;
  return pending_.size() > 1 && Clock::now() - resting_->since >= kPatience * rest_for_;
}

fs::path GrowingFolder::next(const Monitor& monitor) {
  for (;;) {
    check_stop(monitor);
    read_events(monitor);
    read_folder();
    if (const std::string first = pending_.empty() ? "" : *pending_.begin();
        !first.empty() && is_complete(first, monitor)) {
      last_ = first;
      pending_.erase(last_);
      renamed_.erase(last_);
      closed_.erase(last_);
      return folder_ / last_;
    }
    pollfd events{events_, POLLIN, 0};  // poll ignores a negative descriptor
    ::poll(&events, 1, kMaxDelayMs);
  }
}

}  // namespace vpr
