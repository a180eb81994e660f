// A query whose frames come one after the other.
#pragma once

#include "matching/fastable_online.h"
#include "matching/live_frames.h"
#include "matching/match_filter.h"
#include "pipeline/query.h"

namespace vpr {

/// Throws Error(usage) for settings by which what is said of a frame depends on later ones, or
/// which have no method that goes frame by frame.
void check_live(const SequenceQuerySettings& settings);

/// What run_query gives of every window, as soon as its last frame is known, by the same steps. It
/// keeps no more of the frames that have passed than a window needs.
class LiveQuery {
 public:
  /// Throws what check_live and plan_query throw, and Error(usage) where what leaves a window can't
  /// be kept in memory. The database must outlive the query.
  LiveQuery(const SequenceDatabase& database, const std::string& query_name,
            const SequenceQuerySettings& settings, const QueryResources& resources,
            const Monitor& monitor);

  /// Takes the next frame. Gives a result of one window, of which this frame is the last, without
  /// clusters; nothing where the frames do not fill a window.
  std::optional<Result> take(const FrameRow& frame);

  const QueryPlan& plan() const { return plan_; }

 private:
  struct Found;
  void match_window(const RowConsumer& consume);
  void match_path(Found& found, const RowConsumer& consume);

  QueryResources resources_;
  QueryPlan plan_;
  LiveFrames frames_;
  FastableState sums_;
  std::optional<FilteredQuery> filtered_;
  size_t in_a_row_ = 0;  ///< readable frames that came last
};

}  // namespace vpr
