// Reads videos with FFmpeg's libraries: frames as their container shows them, with its times.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "base/monitor.h"
#include "recordings/decode.h"
#include "recordings/sequence_source.h"

namespace vpr {

/// The treatment of an undecodable frame: it ends the work, or it keeps its index and is skipped.
enum class Unreadable { fail, skip };

/// A frame of a video.
struct IndexedFrame {
  size_t index = 0;     ///< in the range
  size_t recorded = 0;  ///< in the video
  /// In nanoseconds since the first frame of the video; nullopt: the video has no valid time.
  std::optional<int64_t> time_ns;
  cv::Mat image;  ///< upright, 8 bits; empty if it cannot be decoded
};

/// Reads the frames of a video's range in order, without seeking. Frames that the edit list of an
/// MP4 or MOV video hides do not count. 10-bit color is reduced to 8 bits.
class VideoReader {
 public:
  /// `format` nullopt: without images. `unreadable`: of damaged frames, and of a video that ends
  /// too early; decides in finish(). Throws Error(input) for a file that is not a video,
  /// Error(usage) for frames that are too large.
  VideoReader(const SequenceArgument& argument, std::optional<PixelFormat> format,
              Unreadable unreadable);
  ~VideoReader();

  /// For a video with more than 8 bits of gray, or 16 bits of red, green and blue: reads it once,
  /// and scales all frames by their common range from then on, as decode_image does. Other videos
  /// are not read. Throws as the constructor does.
  void find_range(const Monitor& monitor);

  /// False at the end of the range.
  bool next(IndexedFrame& frame, const Monitor& monitor);

  /// The sequence that was read, after next() has returned false. Throws Error(usage) for a range
  /// that exceeds the video, Error(input) for one without frames, and, with Unreadable::fail, for a
  /// video that ends well before its stated duration, or that has undecodable frames.
  Sequence finish(const Monitor& monitor);

  /// As stated by the video; 0: unknown.
  size_t expected_frames() const;
  /// As stated by the video; 0: unknown.
  double frames_per_second() const;

 private:
  class Decoder;

  bool decode_below(uint64_t position, const Monitor& monitor);

  SequenceArgument argument_;
  std::optional<PixelFormat> format_;
  Unreadable unreadable_;
  std::optional<PixelRange> range_;
  std::unique_ptr<Decoder> decoder_;
  Sequence sequence_;
  uint64_t position_ = 0;
  bool ended_ = false;
};

/// The presentation times of the frames of a video's range, in nanoseconds since the first frame of
/// the video. Frames without a time are interpolated, or continued at the mean rate. With a
/// warning, all times come from the stated rate if the video has no times, or if they do not
/// increase. Throws Error(input) for a file that is not a video, and for a video with neither.
std::vector<int64_t> read_video_times(const SequenceArgument& argument, const Monitor& monitor);

}  // namespace vpr
