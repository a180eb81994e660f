#include "pipeline/shared_frames.h"

#include <utility>

namespace vpr {

Sequence own_frames(Sequence sequence, const Share& share) {
  if (!share.is_alone() && sequence.kind == SequenceKind::images && sequence.picture == nullptr)
    sequence.own = own_part(share, sequence.files.size());
  return sequence;
}

bool is_in_parts(const Sequence& sequence) { return sequence.own.has_value(); }

void join_unreadable(FrameList& frames, const Sequence& sequence, const Share& share) {
  frames.unreadable = joined(share, NeededBy::all, std::move(frames.unreadable));
  check_any_decoded(frames, sequence);
}

}  // namespace vpr
