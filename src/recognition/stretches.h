// Long walks are compared in stretches, evenly spread.
#pragma once

#include <vector>

#include "descriptors/descriptor_rows.h"

namespace vpr {

/// Frames of a walk that are a query of their own.
struct Stretch {
  size_t first = 0;
  size_t count = 0;
  std::vector<size_t> unreadable;  ///< counted from the first

  DescriptorSpan of(const DescriptorSpan& walk) const {
    return {walk.rows.subspan(first, count), unreadable, nullptr,
            walk.words.empty() ? walk.words : walk.words.subspan(first, count)};
  }
};

/// The whole walk, or, where it and `other_frames` make more than most_pairs frame pairs, stretches
/// of 1000 frames or two windows, at least two of them: the first begins and the last ends where
/// the walk does.
std::vector<Stretch> choose_stretches(const DescriptorSpan& walk, size_t other_frames,
                                      size_t window_length, size_t most_pairs);

}  // namespace vpr
