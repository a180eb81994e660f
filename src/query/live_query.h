// A live query: its frames arrive one after the other.
#pragma once

#include <optional>
#include <vector>

#include "query/path_decisions.h"
#include "query/run_query.h"

namespace vpr {

/// A frame that has arrived.
struct ArrivedFrame {
  DescriptorRow descriptor;  ///< zeros for an unreadable frame
  bool is_readable = true;
  std::vector<LocalFeature> features = {};  ///< of a tested frame, with a witness
};

/// The scores of the latest frame. Only the earlier frames that the score stages need are
/// stored: the memory does not grow with the query. Copies share state.
struct LiveScores {
  FrameDistances raw;  ///< of a query without frames
  std::vector<StartedStage> stages;
  std::vector<uint8_t> bytes;      ///< of the stored rows, the latest frame last
  std::vector<size_t> unreadable;  ///< of the stored rows
  FrameDistances scores;           ///< of the stored rows
  size_t frames = 0;               ///< that have arrived

  /// The row of the latest frame, which must exist.
  size_t last_row() const { return scores.query_frames - 1; }
};

/// `raw`: of a query without frames, with of_query.
LiveScores start_live(const FrameDistances& raw, const ScoreStages& stages);

/// Adds the next frame, which is copied. Rows of `scores` are valid until the next call.
void add_frame(LiveScores& live, const ArrivedFrame& frame);

/// The decisions at a frame, as those of run_query. Query windows are those of the whole query.
struct LiveAnswer {
  std::optional<Match> best;     ///< of the window that ends at the frame
  std::optional<double> margin;  ///< of the best match, in score per frame
  std::optional<double> rate;    ///< training frames per query frame, by the filter
  /// The recognitions of the window; with the filter, those that this frame decides, by query
  /// frame.
  std::vector<Match> recognized;
};

/// Answers each frame of a query as it arrives, by the steps of run_query.
class LiveQuery {
 public:
  /// `settings`: of vpr-query live (choose_query). Throws what plan_query throws, and
  /// Error(usage) if the distances of a window exceed the memory limit. The database must outlive
  /// the query.
  LiveQuery(const SequenceDatabase& database, const std::string& query_name,
            const SequenceQuerySettings& settings, const QueryResources& resources,
            const Monitor& monitor);

  /// Adds the next frame. Nullopt if the last c_l frames are not all readable.
  std::optional<LiveAnswer> take(const ArrivedFrame& frame);

  /// With the filter: the last answer with the recognitions that the end of the query decides;
  /// nullopt without recognitions.
  std::optional<LiveAnswer> finish();

  /// The names and settings of answers, without matches.
  const Result& shape() const { return plan_.result; }

 private:
  QueryPlan plan_;
  LiveScores frames_;
  WindowStage windows_;
  size_t readable_frames_ = 0;  ///< consecutive ones, up to the latest frame

  // With the filter:
  std::optional<LiveAnswer> take_path(const QueryFrame& frame, const ArrivedFrame& arrived);
  std::vector<Match> matches_of(const std::vector<Cell>& cells) const;
  std::optional<PathDecisions> decisions_;
  std::optional<WitnessStage> witness_;
  std::optional<LiveAnswer> last_;  ///< of the latest frame
};

}  // namespace vpr
