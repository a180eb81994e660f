// Live frames: from a recording, a camera, or a pipe of paths.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include <opencv2/videoio.hpp>

#include "base/monitor.h"
#include "recordings/frames.h"

namespace vpr {

/// A frame that has arrived: an image file, an image of a video, or a descriptor; none of them if
/// it is missing.
struct LiveFrame {
  std::string name;  ///< as in Sequence::frame_names
  std::filesystem::path file;
  std::shared_ptr<const cv::Mat> picture;      ///< of a video or camera; null: not decoded yet
  bool is_unreadable = false;                  ///< the image of a video cannot be decoded
  bool may_be_gone = false;                    ///< omitted if the file does not exist
  std::shared_ptr<const NpyArray> array = {};  ///< a descriptor in memory, 1 x d; null: an image

  bool is_missing() const { return file.empty() && !picture && !array; }
  bool is_gone() const;  ///< omitted
  /// A sequence with this frame only, for describing it; this object must outlive it.
  SequenceSource sequence() const;
};

/// A source of live frames.
struct LiveSource {
  /// Waits for the next frame; nullopt at the end. Throws Error(interrupted) once the user wants to
  /// stop, and Error(input) for unreadable input.
  std::function<std::optional<LiveFrame>(const Monitor& monitor)> next;
};

/// Opens a source. A folder, a list and a video end. A device has no end: it must be a camera of
/// Video4Linux (follow_camera). `unreadable`: for a video that ends too early, as in
/// for_each_frame. Throws as open_sequence does, Error(input) for a device that is busy or not a
/// camera, and Error(usage) for its frames if they are too large.
LiveSource open_live_source(const SequenceArgument& argument, Unreadable unreadable);

/// Image paths, one per line, from a file descriptor that stays open: relative to the working
/// directory. Ignores empty lines, those that start with #, and names that a folder ignores
/// (is_frame_name), with a warning for the first one that is not hidden. Ends at the end of the
/// input.
LiveSource open_live_pipe(int descriptor);

/// A source for an open capture of any kind. Frames are counted as they arrive: a range skips the
/// first ones, selects every STEP-th, and ends before LAST. next() waits for the next frame; a
/// signal ends a wait for Video4Linux. It throws Error(input) if there are no more frames: the
/// camera was unplugged, or did not respond for the ten seconds that OpenCV waits.
LiveSource follow_camera(std::unique_ptr<cv::VideoCapture> capture,
                         const SequenceArgument& argument);

}  // namespace vpr
