// Frames of a sequence that several processes describe, each a part of them.
#pragma once

#include <vector>

#include "base/share.h"
#include "images/frames.h"
#include "images/sequence.h"

namespace vpr {

/// Who needs what was described.
enum class NeededBy { first, all };

/// The sequence, of whose image files this process describes its part only. Videos, which are
/// decoded frame after frame, and descriptors are described by every process as a whole.
Sequence own_frames(Sequence sequence, const Share& share);

/// Whether the processes describe parts of it.
bool is_in_parts(const Sequence& sequence);

/// What the processes that need it know of their parts, one after the other; of the others, what
/// they have. `sequence`: of own_frames, in parts.
template <class T>
std::vector<T> joined(const Share& share, NeededBy needed, std::vector<T> own) {
  std::vector<T> all = collected(share, "descriptions", own);
  return needed == NeededBy::all ? spread(share, "descriptions", std::move(all)) : all;
}

/// Adds the unreadable frames of the other parts. Throws Error(input) as for_each_frame does where
/// no frame of any part can be decoded.
void join_unreadable(FrameList& frames, const Sequence& sequence, const Share& share);

}  // namespace vpr
