// A query whose frames arrive one after the other.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "match/fastable_online.h"
#include "match/rows.h"
#include "match/zscores.h"
#include "run/query.h"

namespace vpr {

/// A frame that has come.
struct FrameRow {
  DescriptorRow descriptor;  ///< of a frame that can't be read, zeros
  bool is_readable = true;
  WordSet words = {};  ///< that it shows, where FAB-MAP is asked, too
};

/// The distances of the frame that came last. Of the frames before it only those are kept from
/// which something may still be learned, so that a query may go on for ever. Copies share state.
struct LiveFrames {
  FrameDistances raw;                  ///< of a query without frames
  std::shared_ptr<ZScoreState> state;  ///< of z-scores; null for distances
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
/// z-scores that are no offline ones; null for distances.
LiveFrames start_live(FrameDistances raw, const ScoreBasis* basis);

/// The next frame, which is copied. Rows of `distances` hold until the next call.
void add_frame(LiveFrames& live, FrameRow frame);

/// What run_query gives of every window, as soon as its last frame is known, by the same steps. It
/// keeps no more of the frames that have passed than a window needs.
class LiveQuery {
 public:
  /// `settings`: resolved with the choice --follow. Throws what plan_query throws, and Error(usage)
  /// where what leaves a window can't be kept in memory. The database must outlive the query.
  LiveQuery(const SequenceDatabase& database, const std::string& query_name,
            const ResolvedSettings& settings, const QueryResources& resources,
            const Monitor& monitor);

  /// Takes the next frame. Gives a result of one window, of which this frame is the last, without
  /// clusters; nothing where the frames do not fill a window.
  std::optional<Result> take(const FrameRow& frame);

  const QueryPlan& plan() const { return plan_; }

 private:
  QueryResources resources_;
  QueryPlan plan_;
  LiveFrames frames_;
  WindowStage windows_;
  size_t in_a_row_ = 0;  ///< readable frames that came last
};

}  // namespace vpr
