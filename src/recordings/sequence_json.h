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
                    inner("name", selection.speed, "varying, stops, reversed, kidnap or a number.");
                    inner("seed", selection.seed, "Seed of the random numbers.");
                    inner("frames", selection.recorded_frames, "Frames of the recording.");
                  }}},
        "Simulated speed of the query (--speed). Absent: as recorded.");
  visit("resampled",
        PresentIf{[&] { return selection.selected_fps > 0; }, NestedObject{[&](auto&& inner) {
                    inner("fps", selection.selected_fps, "Requested frame rate.", above(0));
                    inner("frames", selection.recorded_frames, "Frames of the recording.");
                  }}},
        "Selection of frames by rate (--fps); frames, windows and indices count selected frames. "
        "Absent: all frames.");
}

inline constexpr std::string_view kUnreadableText =
    "Indices (from 0) of frames that could not be decoded.";

/// Visits "name" and "frames" (their number), then `own`, then everything else that is known except
/// the names of frames, "unreadable" and the selected frames.
template <class Visitor, class Own>
void visit_sequence(Sequence& sequence, Visitor&& visit, const Own& own) {
  visit("name", sequence.name, "Name of the sequence.");
  visit("frames", sequence.frames, "Frames; of FAB-MAP, places.");
  own();
  visit("fps", IfSet{sequence.fps}, "Frames per second.", above(0));
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
