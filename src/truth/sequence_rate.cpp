#include "truth/sequence_rate.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/npy.h"
#include "base/text.h"
#include "sequence/sequence_source.h"
#include "sequence/video_reader.h"
#include "truth/times.h"

namespace vpr {

namespace {

constexpr size_t kDigitsOfClock = 10;  // seconds since 1970
constexpr double kClearlyAbove = 1.05;

std::string text_of(const SequenceArgument& argument) {
  return argument.path.string() + range_text(argument.range);
}

// For sequences other than videos.
size_t count_frames(const SequenceSource& sequence) {
  if (!sequence.is_one_array()) return sequence.files.size();
  SequenceArgument argument = sequence.argument;
  argument.range.last = argument.range.last.value_or(NpyArray(argument.path).shape().at(0));
  return frame_count(argument.range).value_or(0);
}

// The times of the frames of a sequence, or nullopt if unknown.
std::optional<std::vector<int64_t>> find_times(const SequenceArgument& argument,
                                               const RateSource& source, const Monitor& monitor) {
  if (!source.times.empty()) return read_frame_times(source.times, monitor);
  const SequenceSource sequence = open_sequence(argument);
  if (sequence.kind == SequenceKind::video) return read_video_times(argument, monitor);
  if (!sequence.is_one_array() && is_named_by_time(sequence.files.front()))
    return times_of_names(sequence);
  if (!source.recorded_fps) return std::nullopt;
  return even_times(count_frames(sequence),
                    *source.recorded_fps / static_cast<double>(argument.range.step));
}

// Does not inspect every frame: for videos, returns the stated rate.
std::optional<double> stated_rate(const SequenceArgument& argument, const RateSource& source,
                                  const Monitor& monitor) {
  const SequenceSource sequence = open_sequence(argument);
  if (source.times.empty() && sequence.kind == SequenceKind::video) {
    const double fps = VideoReader(argument, PixelFormat::gray).frames_per_second();
    if (!(fps > 0 && fps <= kMostFps)) return std::nullopt;
    return fps / static_cast<double>(argument.range.step);
  }
  try {
    const auto times = find_times(argument, source, monitor);
    return times ? median_fps(*times) : std::nullopt;
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::data) throw;
    return std::nullopt;  // names that are not times after all
  }
}

void check_count(const SequenceArgument& argument, const RateSource& source, size_t times) {
  const SequenceSource sequence = open_sequence(argument);
  if (source.times.empty() || sequence.kind == SequenceKind::video) return;
  if (const size_t frames = count_frames(sequence); frames != times)
    throw Error(ErrorKind::data,
                fmt::format("{}: has {}, but {} has {}", source.times.string(),
                            counted(times, "time"), text_of(argument), counted(frames, "frame")));
}

/// The times of successive frames.
class FrameClock {
 public:
  explicit FrameClock(std::optional<double> recorded_fps) : recorded_fps_(recorded_fps) {}

  int64_t next(const LiveFrame& frame) {
    const std::string name = frame.file.stem().string();
    if (frames_ == 0 && is_named_by_time(frame.file)) unit_ = unit_of_time(name);
    const int64_t time = unit_ ? read_time({frame.file.string()}, name, *unit_) : even_time(frame);
    if (frames_ > 0 && time <= last_) refuse_time_order({frame.file.string()}, last_, time);
    ++frames_;
    return last_ = time;
  }

 private:
  int64_t even_time(const LiveFrame& frame) const {
    if (!recorded_fps_)
      throw Error(ErrorKind::usage, fmt::format("{}: its time is unknown, which --fps needs. Use "
                                                "--recorded-fps, or images with times as names",
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
  std::optional<LiveFrame> held_;  ///< the last frame that arrived
};

}  // namespace

bool is_named_by_time(const std::filesystem::path& file) {
  const std::string name = file.stem().string();
  const size_t point = std::min(name.find('.'), name.size());
  const auto is_number = [](std::string_view text) {
    return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
  };
  if (!is_number(std::string_view(name).substr(0, point))) return false;
  return point < name.size() ? is_number(std::string_view(name).substr(point + 1))
                             : name.size() >= kDigitsOfClock && !name.starts_with('0');
}

std::vector<int64_t> even_times(size_t frames, double fps) {
  std::vector<int64_t> times;
  for (size_t i = 0; i < frames; ++i)
    times.push_back(std::llround(static_cast<double>(i) * 1e9 / fps));
  return times;
}

SequenceArgument with_rate(SequenceArgument argument, const RateSource& source,
                           std::optional<double> fps, const Monitor& monitor) {
  if (!fps) {
    argument.sequence.fps = stated_rate(argument, source, monitor);
    return argument;
  }
  const auto times = find_times(argument, source, monitor);
  if (!times)
    throw Error(
        ErrorKind::usage,
        fmt::format(
            "{}: the times of its frames are unknown, which --fps needs. Use --recorded-fps, a "
            "video, images with times as names, or a data set with \"fps\"",
            text_of(argument)));
  check_count(argument, source, times->size());
  const std::optional<double> own = median_fps(*times);
  if (own && *fps > kClearlyAbove * *own)
    warn(monitor, fmt::format("{}: has {:.3g} frames per second; --fps {} cannot add frames, and "
                              "keeps each frame once",
                              text_of(argument), *own, *fps));
  Selection kept = thinned(*times, *fps);
  if (times->size() > kMostThinned * kept.frames())
    throw Error(ErrorKind::usage, fmt::format("{}: --fps {} keeps {} of its {}; use a larger value",
                                              text_of(argument), *fps, kept.frames(),
                                              counted(times->size(), "frame")));
  if (kept.frames() < times->size()) argument.sequence.selection = std::move(kept);
  argument.sequence.fps = own ? std::optional(std::min(*own, *fps)) : std::nullopt;
  return argument;
}

std::unique_ptr<LiveSource> open_thinned_source(std::unique_ptr<LiveSource> source, double fps,
                                                std::optional<double> recorded_fps) {
  return std::make_unique<ThinnedSource>(std::move(source), fps, recorded_fps);
}

}  // namespace vpr
