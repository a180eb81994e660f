// A sequence as the user named it, in databases, queries, results and reports.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/json_fwd.h"
#include "sequence/selection.h"

namespace vpr {

class Fields;

/// A sequence as the user named it. Passed whole, never member by member.
struct Sequence {
  std::string name;
  size_t frames = 0;  ///< number of frames
  /// The names of frames: the image's file name, or "#12" for a video. Empty: unknown.
  std::vector<std::string> frame_names = {};
  /// increasing; frames that keep their index but have no image
  std::vector<size_t> unreadable = {};
  std::optional<double> fps = {};  ///< frames per second, if known
  Selection selection = {};        ///< the selected frames of the recording

  size_t recorded_frames() const { return selection.is_all() ? frames : selection.recorded_frames; }
};

/// The selected frames of `recorded`; the result's selection refers to the recording.
Sequence selected(Sequence recorded, const Selection& selection);

/// Adds "warp" and "thinned", but not the frames.
void add_selection(Json& json, const Selection& selection);

/// Reads the output of add_selection. `max_recorded`: the largest valid number of recorded frames,
/// for a selection whose rate, and whose warp if it has one, are set. Throws Error(data) for
/// damage.
Selection read_selection(const Fields& fields,
                         const std::function<uint64_t(const Selection&)>& max_recorded);

/// A sequence in a file: "name" and "frames" (their number), then the keys of `own`, then
/// everything else that is known except the frames' names, "unreadable" and the selected frames.
Json sequence_json(const Sequence& sequence, const Json& own);

/// Reads the output of sequence_json, and "unreadable". Throws Error(data) for damage, and for more
/// than `most_frames` frames.
Sequence read_sequence(const Fields& fields, uint64_t most_frames);

/// The selected frames of several sequences, one sequence after the other.
std::vector<int32_t> source_rows(std::span<const Sequence* const> sequences);

/// Sets the selected frames of sequences that read_sequence has read, from the rows of source_rows,
/// which `open_rows` opens if needed. Calls `fail`, which must throw, if they do not match.
void read_sources(std::span<Sequence* const> sequences,
                  const std::function<std::vector<int32_t>()>& open_rows,
                  const std::function<void()>& fail);

}  // namespace vpr
