#include "recognition/stretches.h"

#include <algorithm>

namespace vpr {
namespace {

constexpr size_t kStretchFrames = 1000;

Stretch stretch_of(const DescriptorSpan& walk, size_t first, size_t count) {
  Stretch stretch{first, count, {}};
  for (const size_t frame : walk.unreadable)
    if (frame >= first && frame < first + count) stretch.unreadable.push_back(frame - first);
  return stretch;
}

}  // namespace

std::vector<Stretch> choose_stretches(const DescriptorSpan& walk, size_t other_frames,
                                      size_t window_length, size_t most_pairs) {
  const size_t frames = walk.rows.size();
  const size_t length = std::max(kStretchFrames, 2 * window_length);
  if (length >= frames || frames <= most_pairs / other_frames) return {stretch_of(walk, 0, frames)};
  const size_t count = std::max<size_t>(2, most_pairs / other_frames / length);
  std::vector<Stretch> stretches;
  for (size_t s = 0; s < count; ++s)
    stretches.push_back(stretch_of(walk, s * (frames - length) / (count - 1), length));
  return stretches;
}

}  // namespace vpr
