#include <algorithm>
#include <cassert>
#include <memory>
#include <vector>

#include "match/filter_track.h"

namespace vpr {
namespace {

/// A query filtered frame by frame. Valid for one FrameDistances, of z-scores.
struct FilteredQuery {
  FilterState filter;
  PathTrack track;
  PathTrack reversed;             ///< against the direction of the training sequences
  double least_change = 0;        ///< frame distance between keyframes
  std::vector<uint16_t> scores;   ///< of the last frame to all training frames
  std::vector<uint32_t> row;      ///< of the last frame: values of all training frames
  std::vector<uint8_t> keyframe;  ///< descriptor of the last keyframe; empty after a gap
  std::vector<Cell> matches;      ///< of the report
};

// Also computes the scores of frames that are not keyframes, because statistics may be updated.
void find_scores(FilteredQuery& query, const FrameDistances& distances, size_t frame) {
  const auto asked = static_cast<uint32_t>(frame);
  distances.start_row(frame);
  for_each_chunk(distances.train_frames, [&](size_t first, size_t last) {
    distances.tile({&asked, 1}, first, last, query.scores.data() + first, 0);
  });
}

bool is_keyframe(const FilteredQuery& query, const FrameDistances& distances, size_t frame) {
  const DescriptorRows& rows = distances.query.rows;
  return query.keyframe.empty() ||
         distance_of(rows.shape.element).pair(query.keyframe, rows[frame]) >= query.least_change;
}

void write_keyframes(FilteredQuery& query) {
  const FilterCells& cells = query.filter.cells;
  const uint32_t* frames = cells.frames.data();
  const uint32_t* values = query.filter.values.data();
  uint32_t* row = query.row.data();
  for (const CellStretch& run : cells.trained()) {
    const size_t last = run.first + run.count - 1;
    for (size_t cell = run.first; cell < last; ++cell)
      for (size_t frame = frames[cell]; frame < frames[cell + 1]; ++frame)
        row[frame] = values[cell];
    std::fill(row + frames[last], row + run.frames_end, values[last]);
  }
}

// One frame of the best keyframe is better than the others.
void write_best(FilteredQuery& query, size_t position) {
  const FilterCells& cells = query.filter.cells;
  const PathKeyframe& best = query.track.recent.back();
  const size_t end = keyframe_end(cells, run_of(cells, best.cell), best.cell);
  std::fill(query.row.begin() + cells.frames[best.cell],
            query.row.begin() + static_cast<ptrdiff_t>(end), best.value + 1);
  query.row[position] = best.value;
}

// The matches of the query frames of a keyframe before `end`.
void add_matches(FilteredQuery& query, const FrameDistances& distances,
                 const PathKeyframe& keyframe, size_t first, size_t end, double rate) {
  const FilterCells& cells = query.filter.cells;
  const FrameStretch& frames = stretch_of(cells, distances, keyframe.cell);
  for (size_t frame = first; frame < end; ++frame) {
    const size_t position = position_at(cells, keyframe, frame, rate);
    query.matches.push_back(
        {static_cast<uint32_t>(frame), static_cast<uint32_t>(frames.sequence),
         static_cast<uint32_t>(position - frames.first + frames.first_in_sequence),
         keyframe.value});
  }
}

// The report at a query frame, without rate and matches.
PathReport report_at(const PathTrack& track, size_t frame) {
  const size_t open = open_keyframes(track);
  const size_t settled = open == 0 ? frame + 1 : track.recent[track.recent.size() - open].frame;
  return {track.recent.back().path, track.margin, track.first_frame, settled};
}

// The report of the path in the direction of the training sequences.
PathReport full_report_at(FilteredQuery& query, const FrameDistances& distances, size_t frame,
                          bool is_new) {
  const PathTrack& track = query.track;
  PathReport report = report_at(track, frame);
  report.rate = recent_rate(track, query.filter.cells);
  report.is_keyframe = is_new;
  const size_t open = open_keyframes(track);
  const size_t keyframes = track.recent.size();
  const size_t first = keyframes - std::min(path_size(track), is_new ? open + 1 : 1);
  query.matches.clear();
  for (size_t k = first; k < keyframes; ++k) {
    const size_t end = k + 1 < keyframes ? track.recent[k + 1].frame : frame + 1;
    const size_t begin = is_new ? track.recent[k].frame : frame;
    // A path with few keyframes is assumed to have the speed of the training sequence.
    add_matches(query, distances, track.recent[k], begin, end, report.rate.value_or(1));
  }
  report.matches = query.matches;
  return report;
}

FilteredQuery start_filtered(const FrameDistances& distances, const MatchSettings& settings) {
  assert(distances.is_in_order());
  FilteredQuery query;
  const FilterSettings filter =
      adapted_settings(distances, settings.filter, distances.typical_distance);
  query.least_change = filter.keyframe_change * distances.typical_distance;
  query.filter = start_filter(distances, filter, query.least_change);
  apply_passes(query.filter.cells, settings.passes);
  query.track.settings = filter;
  query.track.overlapping = settings.overlapping_sequences;
  query.track.typical_distance = distances.typical_distance;
  query.reversed = query.track;
  query.reversed.follows_decoys = true;
  query.scores.resize(distances.train_frames + kBlockFrames);
  query.row.resize(distances.train_frames);
  return query;
}

// Restarts, as after an unreadable frame.
void restart(FilteredQuery& query) {
  restart_filter(query.filter);
  query.track.recent.clear();
  query.reversed.recent.clear();
  query.keyframe.clear();
}

// Adds the next readable query frame and writes its row. There must be a place.
PathReport add_frame(FilteredQuery& query, const FrameDistances& distances,
                     const QueryFrame& frame) {
  if (frame.consecutive_readable == 1) restart(query);
  find_scores(query, distances, frame.row);
  const bool is_new = is_keyframe(query, distances, frame.row);
  if (is_new) {
    const DescriptorRow row = distances.query.rows[frame.row];
    query.keyframe.assign(row.begin(), row.end());
    advance_filter(query.filter, query.scores);
    const auto distance_to = [&](size_t cell) -> uint32_t {
      return distance_of(distances.query.rows.shape.element)
          .pair(query.keyframe, descriptor_of(query.filter.cells, distances, cell));
    };
    for (PathTrack* track : {&query.track, &query.reversed})
      follow_keyframe(*track, query.filter, frame.number, distance_to);
    write_keyframes(query);
  }
  const PathReport report = full_report_at(query, distances, frame.number, is_new);
  write_best(query, position_at(query.filter.cells, query.track.recent.back(), frame.number,
                                report.rate.value_or(1)));
  return report;
}

}  // namespace

WindowStage filter_stage(const FrameDistances& distances, std::span<const size_t>,
                         const MatchSettings& settings) {
  const auto query = std::make_shared<FilteredQuery>(start_filtered(distances, settings));
  return
      [query](const FrameDistances& rows, const QueryFrame& frame, const StageConsumer& consume) {
        if (frame.consecutive_readable == 0 || query->filter.cells.places == 0) return;
        const PathReport report = add_frame(*query, rows, frame);
        std::vector<ScoreRow> row = whole_row(rows, 1, frame.number, query->row);
        const PathReport reversed = report_at(query->reversed, frame.number);
        for (ScoreRow& piece : row) {
          piece.path = &report;
          piece.reversed = &reversed;
        }
        if (!row.empty()) consume(0, row);
      };
}

}  // namespace vpr
