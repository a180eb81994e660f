#include "images/thinning.h"

#include <utility>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"
#include "base/statistics.h"

namespace vpr {

void check_fps(double fps, std::string_view name) {
  if (!(fps > 0 && fps <= kMostFps))
    throw Error(ErrorKind::usage,
                fmt::format("{} must be above 0 and at most {}, found {}", name, kMostFps, fps));
}

Thinner::Thinner(double fps) : interval_ns_(1e9 / fps) {}

bool Thinner::keeps_before(int64_t time_ns) {
  if (!first_) {
    first_ = last_ = time_ns;
    return false;
  }
  // The tick is the earlier frame's up to half way between both.
  const double middle =
      (static_cast<double>(last_ - *first_) + static_cast<double>(time_ns - *first_)) / 2;
  last_ = time_ns;
  if (tick() > middle) return false;
  tick_ = static_cast<uint64_t>(middle / interval_ns_);
  while (tick() <= middle) ++tick_;
  return true;
}

bool Thinner::keeps_last() const {
  return first_ && tick() <= static_cast<double>(last_ - *first_) + interval_ns_ / 10;
}

Replay thinned(std::span<const int64_t> times_ns, double fps) {
  Thinner thinner(fps);
  Replay kept;
  kept.recorded_frames = times_ns.size();
  kept.fps = fps;
  for (size_t i = 0; i < times_ns.size(); ++i)
    if (thinner.keeps_before(times_ns[i])) kept.sources.push_back(static_cast<uint32_t>(i - 1));
  if (thinner.keeps_last()) kept.sources.push_back(static_cast<uint32_t>(times_ns.size() - 1));
  return kept;
}

std::optional<Replay> kept_frames(std::span<const int32_t> sources, uint64_t recorded_frames,
                                  double fps) {
  if (sources.empty() || recorded_frames > kMostThinned * sources.size()) return std::nullopt;
  Replay kept;
  kept.recorded_frames = recorded_frames;
  kept.fps = fps;
  for (const int32_t source : sources) {
    const bool is_behind = kept.sources.empty() || int64_t{source} > kept.sources.back();
    if (source < 0 || !is_behind || static_cast<uint64_t>(source) >= recorded_frames)
      return std::nullopt;
    kept.sources.push_back(static_cast<uint32_t>(source));
  }
  return kept;
}

std::optional<double> median_fps(std::span<const int64_t> times_ns) {
  if (times_ns.size() < 2) return std::nullopt;
  std::vector<double> steps;
  for (size_t i = 1; i < times_ns.size(); ++i)
    steps.push_back(static_cast<double>(times_ns[i] - times_ns[i - 1]));
  return 1e9 / median(std::move(steps));
}

Replay replay_of_kept(const Replay& kept, Replay replay) {
  for (uint32_t& source : replay.sources) source = kept.sources[source];
  replay.recorded_frames = kept.recorded_frames;
  replay.fps = kept.fps;
  return replay;
}

}  // namespace vpr
