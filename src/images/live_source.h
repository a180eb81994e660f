// Frames as they come: of a folder that grows, a camera, a video, a list, or a pipe of paths.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "images/frames.h"

namespace vpr {

/// A frame that came: an image file, or a picture of a video.
struct LiveFrame {
  std::string name;  ///< as FrameList names it
  std::filesystem::path file;
  std::shared_ptr<const cv::Mat> picture;  ///< of a video or camera; null: not decoded yet
  bool is_unreadable = false;              ///< such a picture that can't be decoded

  /// What describes it: a sequence of this frame alone, which must outlive it.
  Sequence sequence() const;
};

class LiveSource {
 public:
  virtual ~LiveSource() = default;
  /// Waits for the next frame; nothing at the end. Throws Error(interrupted) once the user wants to
  /// stop, and Error(input) for what can't be read.
  virtual std::optional<LiveFrame> next(const Monitor& monitor) = 0;
};

/// A folder has no end: what is in it comes first, then what is added (GrowingFolder). Nor has a
/// device, which is a camera (camera.h). A list and a video end. `unreadable`: of a video that ends
/// too early, as for_each_frame has it. Throws what open_sequence and open_camera throw, and
/// Error(usage) for a range of a folder.
std::unique_ptr<LiveSource> open_live_source(const SequenceArgument& argument,
                                             Unreadable unreadable);

/// Image paths, one a line, from a file descriptor that stays open: relative to the working
/// directory; empty lines and those that start with # are skipped. Ends where it ends.
std::unique_ptr<LiveSource> open_live_pipe(int descriptor);

}  // namespace vpr
