// Frames as they arrive: from a growing folder, a camera, a video, a list, or a pipe of paths.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include <opencv2/videoio.hpp>

#include "base/monitor.h"
#include "base/text.h"
#include "sequence/frames.h"

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

/// Whether the path is a device that bytes come from, as /dev/video0 is. Whether it is a camera is
/// only known once it is opened.
bool is_device(const std::filesystem::path& path);

/// The camera of a device, by Video4Linux. Frames are counted as they come: a range leaves out the
/// first ones, takes every STEP-th, and ends before LAST. Throws Error(input) for what is no
/// camera, or is busy, and Error(usage) for frames that are too large.
std::unique_ptr<LiveSource> open_camera(const SequenceArgument& argument);

/// The same of a capture that is open, whatever it reads. next() waits for as long as a frame
/// takes; a signal ends a wait for Video4Linux. It throws Error(input) where no frame comes any
/// more: the camera was unplugged, or says nothing for the ten seconds that OpenCV waits.
std::unique_ptr<LiveSource> follow_camera(std::unique_ptr<cv::VideoCapture> capture,
                                          const SequenceArgument& argument);

/// The images of a folder in natural order, each as soon as it is complete: it was renamed into the
/// folder, a later one is there, or it can be decoded after its writer closed it or after its size
/// has not changed for a while (a file that was there before, or a file system without events,
/// which is read every second). An image that arrives after a later one was taken is
/// omitted, with a warning where there are events.
class GrowingFolder {
 public:
  /// `rest`: how long a size must not change. Throws Error(input) for what can't be read.
  explicit GrowingFolder(const std::filesystem::path& folder,
                         std::chrono::milliseconds rest = std::chrono::seconds(1));
  ~GrowingFolder();
  GrowingFolder(const GrowingFolder&) = delete;
  GrowingFolder& operator=(const GrowingFolder&) = delete;

  /// Waits for the next image, for ever if need be. Throws Error(interrupted) once the user wants
  /// to stop, Error(input) when the folder is gone.
  std::filesystem::path next(const Monitor& monitor);

 private:
  using Clock = std::chrono::steady_clock;
  struct NaturalLess {
    bool operator()(const std::string& a, const std::string& b) const { return natural_less(a, b); }
  };
  /// Whether the first name that waits has rested: its size at a time since when it is the same.
  struct Rest {
    std::string name;
    uintmax_t size = 0;
    Clock::time_point since;
  };

  void look();
  void read_events(const Monitor& monitor);
  void take_event(const std::string& name, uint32_t event, const Monitor& monitor);
  bool is_later(const std::string& name) const;
  bool has_rested(const std::string& name);
  bool can_be_decoded(const std::string& name, const Monitor& monitor);
  bool is_complete(const std::string& name, const Monitor& monitor);
  void wait() const;

  std::filesystem::path folder_;
  Clock::duration rest_for_;
  int events_ = -1;  ///< what the system tells of the folder; -1: nothing
  std::optional<Clock::time_point> looked_;
  std::filesystem::file_time_type changed_;  ///< when it was looked at
  std::set<std::string, NaturalLess> waiting_;
  std::set<std::string> renamed_;  ///< waiting names that were renamed into the folder
  std::set<std::string> closed_;   ///< waiting names whose writer closed them
  std::string last_;               ///< that was given
  std::optional<Rest> resting_;
  std::string incomplete_;  ///< that a warning named
};

}  // namespace vpr
