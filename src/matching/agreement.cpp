#include "matching/agreement.h"

#include <algorithm>

namespace vpr {
namespace {

constexpr double kFirstFrames = 5;
constexpr double kFirstRatio = 0.6;
constexpr int kFrameBits = 40;

/// Where a matched training frame is.
struct Position {
  size_t walk = 0;
  size_t frame = 0;
};

Position position_of(size_t frame, std::span<const FusedWalk> walks) {
  Position position{0, frame};
  while (position.frame >= walks[position.walk].frames)
    position.frame -= walks[position.walk++].frames;
  return position;
}

bool are_near(size_t a, size_t b, std::span<const FusedWalk> walks) {
  const Position first = position_of(a, walks);
  return first.walk == position_of(b, walks).walk &&
         std::max(a, b) - std::min(a, b) <= walks[first.walk].neighbours;
}

// That any training frame is near this one.
double chance(size_t frame, std::span<const FusedWalk> walks) {
  size_t all = 0;
  for (const FusedWalk& walk : walks) all += walk.frames;
  const size_t near = 2 * walks[position_of(frame, walks).walk].neighbours + 1;
  return std::min(1.0, static_cast<double>(near) / static_cast<double>(all));
}

}  // namespace

void Agreement::count(const BestFrames& best, std::span<const FusedWalk> walks) {
  if (best.likeliest && best.closest) {
    if (last.likeliest && last.closest) {
      const double expected = chance(*last.likeliest, walks);
      likeliest_steps += are_near(*last.likeliest, *best.likeliest, walks) - expected;
      closest_steps += are_near(*last.closest, *best.closest, walks) - expected;
    }
    together += are_near(*best.likeliest, *best.closest, walks) - chance(*best.likeliest, walks);
  }
  last = best;
}

double Agreement::ratio() const {
  const double likeliest = std::max(0.0, (likeliest_steps + together) / 2);
  return (likeliest + kFirstFrames * kFirstRatio) / (std::max(0.0, closest_steps) + kFirstFrames);
}

void ClosestFrame::add(uint16_t score, size_t frame) {
  const uint64_t found = uint64_t{score} << kFrameBits | frame;
  uint64_t best = best_.load(std::memory_order_relaxed);
  while (found < best && !best_.compare_exchange_weak(best, found, std::memory_order_relaxed)) {
  }
}

std::optional<size_t> ClosestFrame::frame() const {
  const uint64_t best = best_.load(std::memory_order_relaxed);
  if (best == kNone) return std::nullopt;
  return static_cast<size_t>(best & ((uint64_t{1} << kFrameBits) - 1));
}

}  // namespace vpr
