// Query frames that come one after the other, without an end.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "matching/standardized_frames.h"

namespace vpr {

/// The distances of the frame that came last. Of the frames before it only those are kept from
/// which something may still be learned, so that a query may go on for ever. Copies share state.
struct LiveFrames {
  FrameDistances raw;                        ///< of a query without frames
  std::shared_ptr<StandardizedState> state;  ///< of standardized scores; null for distances
  FusionBasis fusion;
  std::shared_ptr<FusionState> fusion_state;
  std::vector<uint8_t> bytes;      ///< of the rows that are kept, the last frame's last
  std::vector<size_t> unreadable;  ///< of them
  std::vector<WordSet> words;      ///< that they show; of those before the last, none
  FrameDistances distances;        ///< of the rows that are kept
  size_t frames = 0;               ///< that came

  /// The row of the last frame. There must be one.
  size_t last_row() const { return distances.query_frames - 1; }
};

/// `raw`: of a query without frames, and of_query is set. `basis`: of the same training frames, for
/// standardized scores that are no offline ones; null for distances.
LiveFrames start_live(FrameDistances raw, const ScoreBasis* basis);

/// A frame that has come.
struct FrameRow {
  DescriptorRow descriptor;  ///< of a frame that can't be read, zeros
  bool is_readable = true;
  WordSet words = {};  ///< that it shows, where FAB-MAP is asked, too
};

/// The next frame, which is copied. `kept`: another row that is needed, if any, which gets its new
/// index. Rows of `distances` hold until the next call, and are asked for as those of any query.
void add_frame(LiveFrames& live, FrameRow frame, std::optional<size_t>* kept = nullptr);

}  // namespace vpr
