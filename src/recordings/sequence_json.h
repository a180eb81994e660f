// Sequences in JSON files.
#pragma once

#include "base/json.h"
#include "recordings/sequence.h"

namespace vpr {

/// Visits the keys of a selection, "speed" and "resampled"; not the selected frames.
template <class Visitor>
void visit_fields(Selection& selection, Visitor&& visit) {
  visit("speed",
        PresentIf{[&] { return !selection.speed.empty(); }, NestedObject{[&](auto&& inner) {
                    inner("name", selection.speed);
                    inner("seed", selection.seed);
                    inner("frames", selection.recorded_frames);
                  }}});
  visit("resampled",
        PresentIf{[&] { return selection.selected_fps > 0; }, NestedObject{[&](auto&& inner) {
                    inner("fps", selection.selected_fps);
                    inner("frames", selection.recorded_frames);
                  }}});
}

/// Visits "name" and "frames" (their number), then `own`, then everything else that is known except
/// the names of frames, "unreadable" and the selected frames.
template <class Visitor, class Own>
void visit_sequence(Sequence& sequence, Visitor&& visit, const Own& own) {
  visit("name", sequence.name);
  visit("frames", sequence.frames);
  own();
  visit("fps", IfSet{sequence.fps});
  visit_fields(sequence.selection, visit);
}

template <class Visitor>
void visit_fields(Sequence& sequence, Visitor&& visit) {
  visit_sequence(sequence, visit, [] {});
}

/// Throws an error of `source` for values that no sequence has, and for more than `most_frames`
/// frames.
void check_sequence(const Sequence& sequence, uint64_t most_frames, const JsonSource& source);

}  // namespace vpr
