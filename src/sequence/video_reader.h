// A video, frame after frame.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/videoio.hpp>

#include "sequence/frames.h"

namespace vpr {

struct IndexedFrame {
  size_t index = 0;     ///< in the range
  size_t recorded = 0;  ///< in the video
  cv::Mat image;        ///< empty if it can't be decoded
};

/// The picture in a format: grey by BGR2GRAY where it has colours, and as it is otherwise.
cv::Mat in_format(const cv::Mat& image, PixelFormat format);

/// Reads the frames of a video's range in order, without seeking; the only user of the decoder.
class VideoReader {
 public:
  /// Throws Error(input) for what is no video, Error(usage) for frames that are too large.
  VideoReader(const SequenceArgument& argument, PixelFormat format);

  /// False at the end of the range.
  bool next(IndexedFrame& frame, const Monitor& monitor);

  /// What was read, when next() has been false. Throws Error(usage) for a range that exceeds the
  /// video, Error(input) for one without frames, and, with Unreadable::fail, for one that ends well
  /// before the length it states, or that has frames which can't be decoded.
  FrameList finish(Unreadable unreadable, const Monitor& monitor);

  /// By what the video states; 0: not known.
  size_t expected_frames() const;
  /// When the last frame is shown, in milliseconds since the start of the video, as it says itself.
  double shown_at_ms() const;
  /// As the video states it; 0: not known.
  double frames_per_second() const;

 private:
  std::optional<uint64_t> source_of(size_t index) const;
  uint64_t property(cv::VideoCaptureProperties name) const;
  bool retrieve(cv::Mat& image);
  bool grab_below(uint64_t position, const Monitor& monitor);

  SequenceArgument argument_;
  PixelFormat format_;
  cv::VideoCapture capture_;
  FrameList frames_;
  uint64_t position_ = 0;
  bool ended_ = false;
};

/// When the frames of a video's range are shown, in nanoseconds since the start of the video, by
/// the times that it holds, or, where those do not rise, by its frame rate. Throws Error(input) for
/// what is no video, and for one that has neither.
std::vector<int64_t> read_video_times(const SequenceArgument& argument, const Monitor& monitor);

}  // namespace vpr
