#include "sequence/live_source.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>
#include <poll.h>
#include <sys/inotify.h>
#include <unistd.h>

#include "base/error.h"
#include "base/output.h"
#include "base/text.h"
#include "sequence/decode.h"
#include "sequence/frame_order.h"
#include "sequence/sequence_source.h"

namespace vpr {

namespace {

namespace fs = std::filesystem;

constexpr int kMaxDelayMs = 50;  // maximum delay of a stop

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

constexpr std::chrono::seconds kReadEvery(1);  // for folders without events
constexpr int kPatience = 10;  // times the rest, for which later images wait for an incomplete one

Error gone(const fs::path& folder, const std::string& why) {
  return {ErrorKind::input, "{}: can't be read: {}", folder.string(), why};
}

class GrowingFolder {
 public:
  GrowingFolder(const fs::path& folder, std::chrono::milliseconds rest)
      : folder_(folder), rest_for_(rest) {
    std::error_code error;
    if (!fs::is_directory(folder, error)) throw gone(folder, "it is not a folder");
    // Before the folder is read for the first time, so that no file is missed in between.
    events_ = ::inotify_init1(IN_NONBLOCK | IN_CLOEXEC);
    if (events_ < 0) return;
    if (::inotify_add_watch(events_, folder.c_str(),
                            IN_CLOSE_WRITE | IN_MOVED_TO | IN_CREATE | IN_MODIFY) < 0) {
      ::close(events_);
      events_ = -1;
    }
  }
  ~GrowingFolder() {
    if (events_ >= 0) ::close(events_);
  }
  GrowingFolder(const GrowingFolder&) = delete;
  GrowingFolder& operator=(const GrowingFolder&) = delete;

  // Waits without a time limit.
  fs::path next(const Monitor& monitor) {
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
        open_.erase(last_);
        return folder_ / last_;
      }
      pollfd events{events_, POLLIN, 0};  // poll ignores a negative descriptor
      ::poll(&events, 1, kMaxDelayMs);
    }
  }

 private:
  using Clock = std::chrono::steady_clock;
  // The stability of the first pending file: its size, and since when it has not changed.
  struct Rest {
    std::string name;
    uintmax_t size = 0;
    Clock::time_point since;
  };

  void read_folder() {
    const Clock::time_point now = Clock::now();
    if (read_at_ && now - *read_at_ < kReadEvery) return;
    read_at_ = now;
    std::error_code error;
    const fs::file_time_type changed = fs::last_write_time(folder_, error);
    if (error) throw gone(folder_, error.message());
    if (changed == changed_) return;
    changed_ = changed;
    std::vector<std::string> names;
    for (const fs::directory_entry& entry : entries_of(folder_, ErrorKind::input))
      if (is_frame_name(entry.path())) names.push_back(entry.path().filename().string());
    add(names);
  }

  // The names decide the order, unless earlier ones did.
  void add(const std::vector<std::string>& names) {
    if (order_ == nullptr) {
      std::set<std::string> all(names.begin(), names.end());
      all.insert(pending_.begin(), pending_.end());
      if (!last_.empty()) all.insert(last_);
      order_ = name_order({all.begin(), all.end()}, folder_);
      if (order_ != nullptr) pending_ = {pending_.begin(), pending_.end(), order_};
    }
    for (const std::string& name : names)
      if (last_.empty() || pending_.key_comp()(last_, name)) pending_.insert(name);
  }

  void read_events(const Monitor& monitor) {
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

  void handle_event(const std::string& name, uint32_t event, const Monitor& monitor) {
    if (!is_frame_name(name)) return;
    if (!pending_.contains(name)) add({name});
    if (pending_.contains(name)) {
      if ((event & IN_MOVED_TO) != 0) renamed_.insert(name);
      if ((event & IN_MODIFY) != 0) open_.insert(name);
      if ((event & IN_CLOSE_WRITE) != 0) {
        closed_.insert(name);
        open_.erase(name);
        refused_.reset();
      }
    } else if (name != last_ && (event & (IN_CREATE | IN_MOVED_TO)) != 0) {
      warn(monitor, "{}: arrived after {}, which was already used, and is omitted",
           (folder_ / name).string(), last_);
    }
  }

  bool is_complete(const std::string& name, const Monitor& monitor) {
    if (renamed_.contains(name)) return true;
    observe(name);
    if (!resting_) return false;
    if ((closed_.contains(name) || has_rested(name)) && can_be_decoded(name, monitor) &&
        !open_.contains(name))
      return true;
    return pending_.size() > 1 && Clock::now() - resting_->since >= kPatience * rest_for_;
  }

  void observe(const std::string& name) {
    std::error_code error;
    const uintmax_t size = fs::file_size(folder_ / name, error);
    if (error) {  // it no longer exists
      pending_.erase(name);
      resting_.reset();
    } else if (!resting_ || resting_->name != name || resting_->size != size) {
      resting_ = {name, size, Clock::now()};
    }
  }

  bool has_rested(const std::string& name) const {
    std::error_code error;
    const fs::file_time_type written = fs::last_write_time(folder_ / name, error);
    if (error || resting_->size == 0) return false;
    return Clock::now() - resting_->since >= rest_for_ ||
           fs::file_time_type::clock::now() - written >= rest_for_;
  }

  bool can_be_decoded(const std::string& name, const Monitor& monitor) {
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

  fs::path folder_;
  Clock::duration rest_for_;
  int events_ = -1;  // events of the folder; -1: none
  std::optional<Clock::time_point> read_at_;
  fs::file_time_type changed_ = fs::file_time_type::min();  // at the last check
  NameOrder order_ = nullptr;                               // null: not decided
  std::set<std::string, NameOrder> pending_{natural_less};  // names that were not returned yet
  std::set<std::string> renamed_;  // pending names that were renamed into the folder
  std::set<std::string> closed_;   // pending names whose writer closed them
  std::set<std::string> open_;     // pending names that were written to, and not closed since
  std::string last_;               // the last returned name
  std::optional<Rest> resting_;
  std::optional<Rest> refused_;  // could not be decoded, and has not been closed since
  std::string incomplete_;       // named in a warning
};

}  // namespace

SequenceSource LiveFrame::sequence() const {
  if (array) {
    SequenceArgument descriptor{name.empty() ? "frame" : name, {}};
    descriptor.array = array;
    return open_sequence(descriptor);
  }
  return {{file, {}}, SequenceKind::images, {file}, picture.get()};
}

LiveSource open_live_source(const SequenceArgument& argument, Unreadable unreadable) {
  std::error_code error;
  if (fs::is_directory(argument.path, error)) {
    if (!argument.range.is_all())
      throw Error(ErrorKind::usage, "{}: a growing folder cannot have a range. Remove {}",
                  argument.path.string(), range_text(argument.range));
    return follow_folder(argument.path);
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
    return {[=](const Monitor& monitor) -> std::optional<LiveFrame> {
      check_stop(monitor);
      IndexedFrame frame;
      if (!reader->next(frame, monitor)) {
        reader->finish(unreadable, monitor);
        return std::nullopt;
      }
      const bool is_unreadable = frame.image.empty();
      return LiveFrame{fmt::format("#{}", frame.recorded), argument.path,
                       std::make_shared<const cv::Mat>(std::move(frame.image)), is_unreadable};
    }};
  }
  return {[files = sequence.files,
           index = size_t{0}](const Monitor& monitor) mutable -> std::optional<LiveFrame> {
    check_stop(monitor);
    if (index == files.size()) return std::nullopt;
    return image_of(files[index++]);
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

LiveSource follow_folder(const fs::path& folder, std::chrono::milliseconds rest) {
  const auto growing = std::make_shared<GrowingFolder>(folder, rest);
  return {[=](const Monitor& monitor) { return image_of(growing->next(monitor)); }};
}

}  // namespace vpr
