#include "images/frames.h"

#include <algorithm>
#include <atomic>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <oneapi/tbb/parallel_pipeline.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "base/counted.h"
#include "base/error.h"
#include "base/parallel.h"
#include "base/thread_order.h"
#include "images/codec_scope.h"

namespace vpr {
namespace {

using FrameBody = std::function<void(size_t, const cv::Mat&)>;

void lower_to(std::atomic<size_t>& lowest, size_t value) {
  size_t seen = lowest.load();
  while (value < seen && !lowest.compare_exchange_weak(seen, value)) {
  }
}

FrameList for_each_image(const Sequence& sequence, PixelFormat format, Unreadable unreadable,
                         const Monitor& monitor, const FrameBody& body) {
  const size_t count = sequence.files.size();
  std::atomic<size_t> lowest_failed{count};
  std::vector<std::optional<Error>> problems(count);
  StepCounter counter(monitor, "describe", count);
  parallel_for(count, monitor, [&](size_t i) {
    if (i > lowest_failed.load()) return;
    cv::Mat image;
    try {
      image = decode_image(sequence.files[i], format);
    } catch (const Error& error) {
      problems[i] = error;
      const bool is_skipped = unreadable == Unreadable::skip && error.kind() == ErrorKind::input;
      if (!is_skipped) lower_to(lowest_failed, i);
    }
    if (!image.empty()) body(i, image);
    counter.add();
  });
  if (lowest_failed < count) throw Error(*problems[lowest_failed]);
  FrameList frames;
  for (size_t i = 0; i < count; ++i) {
    frames.names.push_back(sequence.files[i].filename().string());
    if (problems[i]) frames.unreadable.push_back(i);
  }
  return frames;
}

struct IndexedFrame {
  size_t index = 0;
  cv::Mat image;
};

/// Reads the frames of a range in order; the only user of the decoder.
class VideoReader {
 public:
  VideoReader(const SequenceArgument& argument, PixelFormat format)
      : argument_(argument), format_(format) {
    const std::string path = argument.path.string();
    bool opened = false;
    try {
      const CodecScope scope(argument_.path);
      opened = capture_.open(path, cv::CAP_FFMPEG);
    } catch (const cv::Exception&) {
      opened = false;
    }
    if (!opened)
      throw Error(ErrorKind::input,
                  fmt::format("{}: is neither a folder of images, a list (.txt) nor a video that "
                              "can be decoded",
                              path));
    check_frame_size(argument_.path, property(cv::CAP_PROP_FRAME_WIDTH),
                     property(cv::CAP_PROP_FRAME_HEIGHT));
  }

  /// False at the end of the range.
  bool next(IndexedFrame& frame, const Monitor& monitor) {
    const FrameRange& range = argument_.range;
    const uint64_t wanted = range.first + frames_.names.size() * range.step;
    if (range.last && wanted >= *range.last) {
      grab_below(*range.last, monitor);  // are there as many frames as the range says?
      return false;
    }
    if (!grab_below(wanted + 1, monitor)) return false;
    frame.index = frames_.names.size();
    frames_.names.push_back(fmt::format("#{}", wanted));
    cv::Mat image;
    if (!retrieve(image)) {
      frames_.unreadable.push_back(frame.index);
      frame.image = cv::Mat();
    } else if (format_ == PixelFormat::grey && image.channels() == 3) {
      cv::cvtColor(image, frame.image, cv::COLOR_BGR2GRAY);
    } else {
      frame.image = image.clone();
    }
    return true;
  }

  FrameList finish(Unreadable unreadable, const Monitor& monitor) {
    const FrameRange& range = argument_.range;
    const std::string path = argument_.path.string();
    if (ended_ && (frames_.names.empty() || range.last))
      throw Error(range.is_all() ? ErrorKind::input : ErrorKind::usage,
                  fmt::format("{}: has only {} to decode{}", path, counted(position_, "frame"),
                              range.is_all() ? "" : " for " + range_text(range)));
    const double stated = capture_.get(cv::CAP_PROP_FRAME_COUNT);
    const bool is_short = ended_ && stated > static_cast<double>(position_) * 1.02 + 2;
    const std::string short_text = fmt::format("{}: ends after {} although it states {:.0f}", path,
                                               counted(position_, "frame"), stated);
    if (unreadable == Unreadable::fail && is_short)
      throw Error(ErrorKind::input,
                  short_text + "; give --skip-unreadable to use the frames that there are");
    if (unreadable == Unreadable::fail && !frames_.unreadable.empty())
      throw Error(ErrorKind::input,
                  fmt::format("{}: frame {} can't be decoded; give --skip-unreadable to go on "
                              "without it",
                              path, frames_.names[frames_.unreadable.front()]));
    if (is_short) warn(monitor, short_text);
    return std::move(frames_);
  }

  size_t expected_frames() const {
    const double stated = capture_.get(cv::CAP_PROP_FRAME_COUNT);
    const FrameRange& range = argument_.range;
    if (!(stated > static_cast<double>(range.first)) || stated > 1e12) return 0;
    const uint64_t last = std::min(range.last.value_or(std::numeric_limits<uint64_t>::max()),
                                   static_cast<uint64_t>(stated));
    return last <= range.first ? 0 : (last - range.first + range.step - 1) / range.step;
  }

 private:
  uint64_t property(cv::VideoCaptureProperties name) const {
    return static_cast<uint64_t>(std::max(0.0, capture_.get(name)));
  }

  // The frame that was grabbed last; it may be larger than the first one.
  bool retrieve(cv::Mat& image) {
    const CodecScope scope(argument_.path);
    return capture_.retrieve(image) && !image.empty();
  }

  // Moves on until `position` frames have been taken; false if there are fewer.
  bool grab_below(uint64_t position, const Monitor& monitor) {
    for (; position_ < position; ++position_) {
      check_stop(monitor);
      if (ended_ || !capture_.grab()) {
        ended_ = true;
        return false;
      }
    }
    return true;
  }

  SequenceArgument argument_;
  PixelFormat format_;
  cv::VideoCapture capture_;
  FrameList frames_;
  uint64_t position_ = 0;
  bool ended_ = false;
};

FrameList for_each_video_frame(const Sequence& sequence, PixelFormat format, Unreadable unreadable,
                               const Monitor& monitor, const FrameBody& body) {
  namespace tbb = oneapi::tbb;
  using FramePointer = std::shared_ptr<IndexedFrame>;
  VideoReader reader(sequence.argument, format);
  StepCounter counter(monitor, "describe", reader.expected_frames());
  const auto read = [&](tbb::flow_control& control) {
    const ThreadOrder::Part part;
    take_over(&reader);
    auto frame = std::make_shared<IndexedFrame>();
    if (!reader.next(*frame, monitor)) control.stop();
    hand_over(&reader);
    hand_over(frame.get());
    return frame;
  };
  const auto describe = [&](const FramePointer& frame) {
    const ThreadOrder::Part part;
    take_over(frame.get());
    if (!frame->image.empty()) body(frame->index, frame->image);
    counter.add();
  };
  {
    const ThreadOrder order;
    tbb::parallel_pipeline(
        2 * thread_count(),
        tbb::make_filter<void, FramePointer>(tbb::filter_mode::serial_in_order, read) &
            tbb::make_filter<FramePointer, void>(tbb::filter_mode::parallel, describe));
  }
  return reader.finish(unreadable, monitor);
}

}  // namespace

FrameList replayed(const FrameList& recorded, Replay replay) {
  FrameList frames;
  frames.names = replayed(recorded.names, replay);
  frames.unreadable = replayed_frames(replay, recorded.unreadable);
  frames.replay = std::move(replay);
  return frames;
}

FrameList for_each_frame(const Sequence& sequence, PixelFormat format, Unreadable unreadable,
                         const Monitor& monitor, const FrameBody& body) {
  if (sequence.kind == SequenceKind::descriptors)
    throw Error(ErrorKind::data, fmt::format("{}: holds descriptors, and images are needed here",
                                             sequence.argument.path.string()));
  FrameList frames = sequence.kind == SequenceKind::video
                         ? for_each_video_frame(sequence, format, unreadable, monitor, body)
                         : for_each_image(sequence, format, unreadable, monitor, body);
  if (frames.unreadable.size() == frames.count())
    throw Error(ErrorKind::input,
                fmt::format("{}: none of its {} can be decoded", sequence.argument.path.string(),
                            counted(frames.count(), "frame")));
  return frames;
}

}  // namespace vpr
