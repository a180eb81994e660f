// A folder that another program fills with images, one after the other.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "base/monitor.h"
#include "images/natural_order.h"

namespace vpr {

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
