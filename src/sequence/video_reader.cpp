#include "sequence/video_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "base/error.h"
#include "base/text.h"
#include "sequence/decode.h"

namespace vpr {

cv::Mat in_format(const cv::Mat& image, PixelFormat format) {
  if (format != PixelFormat::gray || image.channels() != 3) return image.clone();
  cv::Mat gray;
  cv::cvtColor(image, gray, cv::COLOR_BGR2GRAY);
  return gray;
}

VideoReader::VideoReader(const SequenceArgument& argument, PixelFormat format)
    : argument_(argument), format_(format), sequence_(argument.sequence) {
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

bool VideoReader::next(IndexedFrame& frame, const Monitor& monitor) {
  const FrameRange& range = argument_.range;
  const std::optional<uint64_t> source = source_of(sequence_.frames);
  const uint64_t wanted = range.first + source.value_or(0) * range.step;
  if (!source || (range.last && wanted >= *range.last)) {
    // Checks that the video has as many frames as the range or the video states.
    grab_below(range.last.value_or(std::numeric_limits<uint64_t>::max()), monitor);
    return false;
  }
  if (!grab_below(wanted + 1, monitor)) return false;
  frame.index = sequence_.frames++;
  frame.recorded = wanted;
  sequence_.frame_names.push_back(fmt::format("#{}", wanted));
  cv::Mat image;
  if (retrieve(image)) {
    frame.image = in_format(image, format_);
  } else {
    sequence_.unreadable.push_back(frame.index);
    frame.image = cv::Mat();
  }
  return true;
}

// The frame of the range for the next selected frame; nullopt after the last one.
std::optional<uint64_t> VideoReader::source_of(size_t index) const {
  if (sequence_.selection.is_all()) return index;
  const std::vector<uint32_t>& sources = sequence_.selection.sources;
  return index < sources.size() ? std::optional<uint64_t>(sources[index]) : std::nullopt;
}

Sequence VideoReader::finish(Unreadable unreadable, const Monitor& monitor) {
  const FrameRange& range = argument_.range;
  const std::string path = argument_.path.string();
  if (ended_ && (sequence_.frames == 0 || range.last))
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
  if (unreadable == Unreadable::fail && !sequence_.unreadable.empty())
    throw Error(ErrorKind::input,
                fmt::format("{}: frame {} can't be decoded; give --skip-unreadable to go on "
                            "without it",
                            path, sequence_.frame_names[sequence_.unreadable.front()]));
  if (is_short) warn(monitor, short_text);
  return std::move(sequence_);
}

size_t VideoReader::expected_frames() const {
  if (!sequence_.selection.is_all()) return sequence_.selection.frames();
  const double stated = capture_.get(cv::CAP_PROP_FRAME_COUNT);
  const FrameRange& range = argument_.range;
  if (!(stated > static_cast<double>(range.first)) || stated > 1e12) return 0;
  const uint64_t last = std::min(range.last.value_or(std::numeric_limits<uint64_t>::max()),
                                 static_cast<uint64_t>(stated));
  return last <= range.first ? 0 : (last - range.first + range.step - 1) / range.step;
}

uint64_t VideoReader::property(cv::VideoCaptureProperties name) const {
  return static_cast<uint64_t>(std::max(0.0, capture_.get(name)));
}

// Retrieves the last grabbed frame, which may be larger than the first one.
bool VideoReader::retrieve(cv::Mat& image) {
  const CodecScope scope(argument_.path);
  return capture_.retrieve(image) && !image.empty();
}

// Grabs frames until `position` is reached; false if there are fewer.
bool VideoReader::grab_below(uint64_t position, const Monitor& monitor) {
  for (; position_ < position; ++position_) {
    check_stop(monitor);
    if (ended_ || !capture_.grab()) {
      ended_ = true;
      return false;
    }
  }
  return true;
}

double VideoReader::shown_at_ms() const { return capture_.get(cv::CAP_PROP_POS_MSEC); }

double VideoReader::frames_per_second() const { return capture_.get(cv::CAP_PROP_FPS); }

std::vector<int64_t> read_video_times(const SequenceArgument& argument, const Monitor& monitor) {
  VideoReader reader(argument, PixelFormat::gray);
  std::vector<int64_t> times;
  std::vector<int64_t> by_rate;
  bool do_rise = true;
  const double fps = reader.frames_per_second();
  for (IndexedFrame frame; reader.next(frame, monitor);) {
    times.push_back(std::llround(reader.shown_at_ms() * 1e6));
    by_rate.push_back(fps > 0 ? std::llround(static_cast<double>(frame.recorded) * 1e9 / fps) : 0);
    do_rise = do_rise && (times.size() < 2 || times.back() > times[times.size() - 2]);
  }
  if (do_rise) return times;
  if (fps > 0 && fps < 1e6) return by_rate;
  throw Error(ErrorKind::input, fmt::format("{}: has neither times of its frames nor a frame rate",
                                            argument.path.string()));
}

}  // namespace vpr
