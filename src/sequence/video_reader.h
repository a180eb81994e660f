// Reads a video frame by frame.
#pragma once

#include <cstdint>
#include <vector>

#include <opencv2/videoio.hpp>

#include "sequence/frames.h"

namespace vpr {

struct IndexedFrame {
  size_t index = 0;     ///< in the range
  size_t recorded = 0;  ///< in the video
  cv::Mat image;        ///< empty if it cannot be decoded
};

/// The image in a format: color becomes gray by BGR2GRAY if needed.
cv::Mat in_format(const cv::Mat& image, PixelFormat format);

/// Reads the frames of a video's range in order, without seeking; the only user of the decoder.
class VideoReader {
 public:
  /// Throws Error(input) for a file that is not a video, Error(usage) for frames that are too
  /// large.
  VideoReader(const SequenceArgument& argument, PixelFormat format);

  /// False at the end of the range.
  bool next(IndexedFrame& frame, const Monitor& monitor);

  /// The sequence that was read, after next() has returned false. Throws Error(usage) for a range
  /// that exceeds the video, Error(input) for one without frames, and, with Unreadable::fail, for a
  /// video that ends well before its stated length, or that has undecodable frames.
  Sequence finish(Unreadable unreadable, const Monitor& monitor);

  /// As stated by the video; 0: unknown.
  size_t expected_frames() const;
  /// The presentation time of the last frame in milliseconds since the start of the video, as
  /// stated by the video.
  double shown_at_ms() const;
  /// As stated by the video; 0: unknown.
  double frames_per_second() const;

 private:
  std::optional<uint64_t> source_of(size_t index) const;
  uint64_t property(cv::VideoCaptureProperties name) const;
  bool retrieve(cv::Mat& image);
  bool grab_below(uint64_t position, const Monitor& monitor);

  SequenceArgument argument_;
  PixelFormat format_;
  cv::VideoCapture capture_;
  Sequence sequence_;
  uint64_t position_ = 0;
  bool ended_ = false;
};

/// The presentation times of the frames of a video's range, in nanoseconds since its start: the
/// times in the video or, if those do not increase, from its frame rate. Throws Error(input) for a
/// file that is not a video, and for a video with neither.
std::vector<int64_t> read_video_times(const SequenceArgument& argument, const Monitor& monitor);

}  // namespace vpr
