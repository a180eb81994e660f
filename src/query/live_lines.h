// A live query from frames to the lines of JSON of vpr-query live (vpr.live/3).
#pragma once

#include <optional>
#include <string>

#include "query/live_query.h"
#include "query/result_file.h"
#include "recordings/live_source.h"

namespace vpr {

/// The newest frame of a live query.
struct LineFrame {
  size_t number = 0;
  std::string name;
  bool is_readable = true;
};

/// A line, and its schema. `shape`: LiveQuery::shape. Nullopt `answer`: the frame ends no
/// window.
Json live_line(const LineFrame& frame, const Result& shape,
               const std::optional<LiveAnswer>& answer);
Json live_schema();

class LiveLines {
 public:
  /// Throws as LiveQuery does. The database must outlive it.
  LiveLines(const SequenceDatabase& database, const std::string& query_name,
            const SequenceQuerySettings& settings, const QueryResources& resources,
            const Monitor& monitor);

  /// Describes and matches the next frame, and returns as LiveQuery::take does. A frame that cannot
  /// be decoded throws Error(input); with skip_unreadable, it is a warning, and the frame is
  /// missing. A frame that may be gone and is, is a warning, and not counted.
  std::optional<LiveAnswer> take(const LiveFrame& frame, const Monitor& monitor);
  /// As LiveQuery::finish.
  std::optional<LiveAnswer> finish() { return query_.finish(); }
  /// The number of frames that were counted.
  size_t frames() const { return frames_; }
  /// The latest frame; there must be one.
  const LineFrame& last() const { return last_; }
  /// The line of the latest frame with its answer.
  Json line(const std::optional<LiveAnswer>& answer) const {
    return live_line(last_, shape(), answer);
  }
  const Result& shape() const { return query_.shape(); }

 private:
  const SequenceDatabase& database_;
  bool skip_unreadable_;
  FeatureChoice choose_;
  LiveQuery query_;
  size_t frames_ = 0;
  LineFrame last_;
};

}  // namespace vpr
