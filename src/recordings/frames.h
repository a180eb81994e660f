// Decodes the frames of a sequence, one by one or in parallel, without keeping them, and sets up
// the process for it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "base/json_fwd.h"
#include "base/monitor.h"
#include "base/parallel.h"
#include "recordings/decode.h"
#include "recordings/frame_order.h"
#include "recordings/sequence_source.h"

namespace cv {
class VideoCapture;
}

namespace vpr {

/// The treatment of an undecodable frame: it ends the work, or it keeps its index and is skipped.
enum class Unreadable { fail, skip };

using FrameVisitor = std::function<void(size_t index, const cv::Mat& image)>;

/// Calls body(index, image) for each readable frame, in any order, from several threads. Files are
/// decoded in parallel; a video is read frame by frame in one thread, without seeking, while others
/// process its frames. BGR frames of a video are converted to gray by BGR2GRAY. With
/// Unreadable::fail, the first (lowest) undecodable frame throws Error(input); with skip, only a
/// sequence without any readable frame does. A frame above the limit of megapixels throws
/// Error(usage) in both cases, for a video before any frame is decoded. A sequence of descriptors
/// throws Error(data). Returns the sequence of the argument with its frames.
Sequence for_each_frame(const SequenceSource& source, PixelFormat format, Unreadable unreadable,
                        const Monitor& monitor, const FrameVisitor& body);

/// A frame of a video.
struct IndexedFrame {
  size_t index = 0;     ///< in the range
  size_t recorded = 0;  ///< in the video
  cv::Mat image;        ///< empty if it cannot be decoded
};

/// Opens a video or camera with a backend of OpenCV. Returns false if that fails; throws
/// Error(usage) for frames that are too large.
bool open_capture(cv::VideoCapture& capture, const std::filesystem::path& path, int backend);

/// Reads the frames of a video's range in order, without seeking; the only user of the decoder.
class VideoReader {
 public:
  /// Throws Error(input) for a file that is not a video, Error(usage) for frames that are too
  /// large.
  VideoReader(const SequenceArgument& argument, PixelFormat format);
  ~VideoReader();

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
  bool grab_below(uint64_t position, const Monitor& monitor);

  SequenceArgument argument_;
  PixelFormat format_;
  std::unique_ptr<cv::VideoCapture> capture_;
  Sequence sequence_;
  int orientation_ = 1;  // of its frames, as in EXIF
  uint64_t position_ = 0;
  double first_ms_ = 0;  // times of frames
  double last_ms_ = 0;
  bool ended_ = false;
};

/// The presentation times of the frames of a video's range, in nanoseconds since its start: the
/// times in the video or, if those do not increase, from its frame rate. Throws Error(input) for a
/// file that is not a video, and for a video with neither.
std::vector<int64_t> read_video_times(const SequenceArgument& argument, const Monitor& monitor);

/// Settings that belong to the whole process: of every program and of every call from Python.
struct ProcessSettings {
  uint64_t threads = 0;  ///< 0: all cores
  uint64_t seed = 1;
  uint64_t max_megapixels = kDefaultMegapixels;
  FrameOrder order = FrameOrder::automatic;
};
VPR_FIELDS(ProcessSettings, threads, seed, max_megapixels, order)

/// Applies settings to the process during its lifetime, and has OpenCV work on one thread per
/// frame, silently, without code that depends on the processor. Throws Error(usage) for settings
/// out of range.
struct ProcessScope {
  explicit ProcessScope(const ProcessSettings& settings);
  ~ProcessScope();
  ProcessScope(const ProcessScope&) = delete;
  ProcessScope& operator=(const ProcessScope&) = delete;

  ThreadLimit threads;
  uint64_t megapixels_before;
  FrameOrder order_before;
  int cv_threads;
  bool is_cv_optimized;
  int cv_log_level;
};

}  // namespace vpr
