#include "images/live_source.h"

#include <array>
#include <cerrno>

#include <fmt/format.h>
#include <opencv2/core/mat.hpp>
#include <poll.h>
#include <unistd.h>

#include "base/error.h"
#include "base/utf8.h"
#include "images/camera.h"
#include "images/growing_folder.h"
#include "images/video_reader.h"

namespace vpr {
namespace {

namespace fs = std::filesystem;

constexpr int kPatienceMs = 50;  // how long a stop may wait

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

}  // namespace

Sequence LiveFrame::sequence() const {
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
  Sequence sequence = open_sequence(argument);
  if (sequence.kind == SequenceKind::video)
    return std::make_unique<LiveVideo>(argument, unreadable);
  return std::make_unique<LiveList>(std::move(sequence.files));
}

std::unique_ptr<LiveSource> open_live_pipe(int descriptor) {
  return std::make_unique<LivePipe>(descriptor);
}

}  // namespace vpr
