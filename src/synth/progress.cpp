#include "synth/progress.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"

namespace vpr {
namespace {

constexpr size_t kMaxFrames = 100'000;

void check_frames(const Walk& walk, double frames) {
  if (frames > static_cast<double>(kMaxFrames))
    throw Error(ErrorKind::usage, fmt::format("the walk {} would have {} frames; the maximum is {}",
                                              walk.name, frames, kMaxFrames));
}

size_t frame_count(const World& world, const Walk& walk, double length_m) {
  if (walk.frames > 0) return walk.frames;
  const double frames = std::floor(length_m / walk.speed_m_s * world.fps) + 1;
  check_frames(walk, frames);
  return static_cast<size_t>(frames);
}

[[noreturn]] void refuse_missed(const Walk& walk, std::string_view what, double at_m,
                                double length_m) {
  throw Error(ErrorKind::usage,
              fmt::format("the walk {} has a {} {} m, which it does not reach: its path is "
                          "{:.2f} m long, and it passes stops and cuts in their order",
                          walk.name, what, at_m, length_m));
}

double speed_at(const Walk& walk, double way_m) {
  double speed = walk.speed_m_s;
  for (const WalkPace& pace : walk.paces)
    if (pace.from_m <= way_m) speed = pace.speed_m_s;
  return speed;
}

// The end of the part of the path before the next cut.
double leg_end(const Walk& walk, size_t cut, double length_m) {
  return cut == walk.cuts.size() ? length_m : std::min(length_m, walk.cuts[cut].at_m);
}

}  // namespace

bool is_uneven(const Walk& walk) {
  return !walk.paces.empty() || !walk.stops.empty() || !walk.cuts.empty();
}

std::vector<Progress> uneven_progress(const World& world, const Walk& walk, double length_m,
                                      const std::function<double(double time_s)>& variation) {
  for (const WalkCut& known : walk.cuts)
    if (known.to_m > length_m) refuse_missed(walk, "cut to", known.to_m, length_m);
  std::vector<Progress> frames;
  Progress now;
  size_t stop = 0;
  size_t cut = 0;
  for (;;) {
    // Cuts before a step leaves this part; several cuts may follow each other.
    for (; cut < walk.cuts.size() && now.way_m >= walk.cuts[cut].at_m; ++cut) {
      now.way_m = walk.cuts[cut].to_m + (now.way_m - walk.cuts[cut].at_m);
      now.follows_cut = !frames.empty();
    }
    const double end_m = leg_end(walk, cut, length_m);
    if (now.way_m > end_m) break;
    frames.push_back(now);
    now.follows_cut = false;
    check_frames(walk, static_cast<double>(frames.size()));
    if (stop < walk.stops.size() && walk.stops[stop].at_m == now.way_m) {
      const auto standing = static_cast<size_t>(std::floor(walk.stops[stop].seconds * world.fps));
      check_frames(walk, static_cast<double>(frames.size() + standing));
      frames.insert(frames.end(), standing, now);
      ++stop;
    }
    const double time_s = static_cast<double>(frames.size()) / world.fps;
    double next = now.way_m + speed_at(walk, now.way_m) * (1 + variation(time_s)) / world.fps;
    const bool stands = stop < walk.stops.size() && walk.stops[stop].at_m >= now.way_m &&
                        walk.stops[stop].at_m <= std::min(next, end_m);
    if (stands) next = walk.stops[stop].at_m;
    now.way_m = next;
    now.walking_s += 1 / world.fps;
  }
  if (stop < walk.stops.size()) refuse_missed(walk, "stop at", walk.stops[stop].at_m, length_m);
  if (cut < walk.cuts.size()) refuse_missed(walk, "cut at", walk.cuts[cut].at_m, length_m);
  return frames;
}

std::vector<Progress> even_progress(const World& world, const Walk& walk, double length_m,
                                    const std::function<double(double time_s)>& variation) {
  const size_t count = frame_count(world, walk, length_m);
  std::vector<double> shares(count, 0);
  for (size_t i = 1; i < count; ++i)
    shares[i] = shares[i - 1] + 1 + variation(static_cast<double>(i) / world.fps);
  const double all = count > 1 ? shares.back() : 1;
  std::vector<Progress> frames;
  for (size_t i = 0; i < count; ++i)
    frames.push_back({shares[i] / all * length_m, static_cast<double>(i) / world.fps, false});
  return frames;
}

}  // namespace vpr
