#include "ground_truth/thinned_source.h"

#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "ground_truth/sequence_rate.h"
#include "ground_truth/times.h"
#include "images/selection.h"

namespace vpr {
namespace {

/// When frames were taken, one after the other.
class FrameClock {
 public:
  explicit FrameClock(std::optional<double> recorded_fps) : recorded_fps_(recorded_fps) {}

  int64_t next(const LiveFrame& frame) {
    const std::string name = frame.file.stem().string();
    if (frames_ == 0 && is_named_by_time(frame.file)) unit_ = unit_of_time(name);
    const int64_t time = unit_ ? named_time(frame, name) : even_time(frame);
    if (frames_ > 0 && time <= last_) refuse_time_order({frame.file.string()}, last_, time);
    ++frames_;
    return last_ = time;
  }

 private:
  int64_t named_time(const LiveFrame& frame, const std::string& name) const {
    return read_time({frame.file.string()}, name, *unit_);
  }

  int64_t even_time(const LiveFrame& frame) const {
    if (!recorded_fps_)
      throw Error(ErrorKind::usage,
                  fmt::format("{}: nothing says when it was taken, which --fps needs: give "
                              "--recorded-fps, or images that are named by their times",
                              frame.file.string()));
    return std::llround(static_cast<double>(frames_) * 1e9 / *recorded_fps_);
  }

  std::optional<double> recorded_fps_;
  std::optional<TimeUnit> unit_;
  size_t frames_ = 0;
  int64_t last_ = 0;
};

class ThinnedSource : public LiveSource {
 public:
  ThinnedSource(std::unique_ptr<LiveSource> source, double fps, std::optional<double> recorded_fps)
      : source_(std::move(source)), thinner_(fps), clock_(recorded_fps) {}

  std::optional<LiveFrame> next(const Monitor& monitor) override {
    for (;;) {
      std::optional<LiveFrame> frame = source_->next(monitor);
      if (!frame) return thinner_.keeps_last() ? std::exchange(held_, std::nullopt) : std::nullopt;
      const bool is_kept = thinner_.keeps_before(clock_.next(*frame));
      std::optional<LiveFrame> before = std::exchange(held_, std::move(frame));
      if (is_kept) return before;
    }
  }

 private:
  std::unique_ptr<LiveSource> source_;
  Thinner thinner_;
  FrameClock clock_;
  std::optional<LiveFrame> held_;  ///< the last that came
};

}  // namespace

std::unique_ptr<LiveSource> open_thinned_source(std::unique_ptr<LiveSource> source, double fps,
                                                std::optional<double> recorded_fps) {
  return std::make_unique<ThinnedSource>(std::move(source), fps, recorded_fps);
}

}  // namespace vpr
