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
  Rescoring rescoring;
  std::vector<uint16_t> scores;  ///< of the last frame to all training frames
  std::vector<uint32_t> row;     ///< of the last frame: values of all training frames
  std::vector<uint8_t> view;     ///< descriptor of the last keyframe; empty after a gap
};

// Also computes the scores of frames that are not keyframes, because statistics may be updated.
void find_scores(FilteredQuery& query, const FrameDistances& distances, size_t frame) {
  const auto asked = static_cast<uint32_t>(frame);
  distances.start_row(frame);
  for_each_chunk(distances.train_frames, [&](size_t first, size_t last) {
    distances.tile({&asked, 1}, first, last, query.scores.data() + first, 0);
  });
}

// The change since the last keyframe.
double change_since(const FilteredQuery& query, const FrameDistances& distances, size_t frame) {
  const DescriptorRows& rows = distances.query.rows;
  return query.view.empty() ? 0 : distance_of(rows.shape.element).pair(query.view, rows[frame]);
}

double in_typical(double change, double typical_distance) {
  return typical_distance > 0 ? change / typical_distance : 0;
}

// The change of the training sequence between two places of a sequence.
double train_change(const FilterCells& cells, const FrameDistances& distances, size_t from,
                    size_t to) {
  const auto index = static_cast<size_t>(&run_of(cells, to) - cells.runs.data());
  const FrameRun& run = distances.train_runs[index];
  const size_t first = run.first - run.first_in_sequence;
  return frame_distance(distances.train[run.sequence].rows, cells.frames[from] - first,
                        cells.frames[to] - first);
}

QueryKeyframe query_view(FilteredQuery& query, const FrameDistances& distances, size_t number,
                         double change) {
  const double typical = distances.typical_distance;
  const auto rescore_path = [&query, &distances](size_t cell, bool begins) {
    if (begins) query.rescoring.views.clear();
    add_keyframe(query.rescoring, query.filter.cells, query.scores, distances.scale, cell);
    return rescore(query.rescoring, query.filter.cells, distances.learned_scale);
  };
  const auto walked = [&query, &distances, typical](size_t from, size_t to) {
    return in_typical(train_change(query.filter.cells, distances, from, to), typical);
  };
  return {number, in_typical(change, typical), rescore_path, walked};
}

void write_views(FilteredQuery& query) {
  const FilterCells& cells = query.filter.cells;
  const uint32_t* frames = cells.frames.data();
  const uint32_t* values = query.filter.values.data();
  uint32_t* row = query.row.data();
  for (const CellRun& run : cells.runs) {
    const size_t last = run.first + run.count - 1;
    for (size_t cell = run.first; cell < last; ++cell)
      for (size_t frame = frames[cell]; frame < frames[cell + 1]; ++frame)
        row[frame] = values[cell];
    std::fill(row + frames[last], row + run.frames_end, values[last]);
  }
}

// One frame of the best keyframe is better than the others.
void write_best(FilteredQuery& query, const PathFrame& path) {
  const FilterCells& cells = query.filter.cells;
  const uint32_t value = query.filter.values[path.cell];
  const size_t end = view_end(cells, run_of(cells, path.cell), path.cell);
  std::fill(query.row.begin() + cells.frames[path.cell],
            query.row.begin() + static_cast<ptrdiff_t>(end), value + 1);
  query.row[path.frame] = value;
}

FilteredQuery start_filtered(const FrameDistances& distances, const MatchSettings& settings) {
  assert(distances.is_in_order());
  FilteredQuery query;
  query.filter = start_filter(distances, settings.filter,
                              settings.filter.keyframe_change * distances.typical_distance);
  query.rescoring = start_rescoring(query.filter);
  query.track.kernels = settings.kernels;
  query.track.shared = settings.overlapping_sequences;
  query.scores.resize(distances.train_frames + kBlockFrames);
  query.row.resize(distances.train_frames);
  return query;
}

// Restarts, as after an unreadable frame.
void restart(FilteredQuery& query) {
  restart_filter(query.filter);
  query.track.views = 0;
  query.view.clear();
}

// Adds the next readable query frame and writes its row. There must be a place.
PathReport add_frame(FilteredQuery& query, const FrameDistances& distances,
                     const QueryFrame& frame) {
  if (frame.in_a_row == 1) restart(query);
  find_scores(query, distances, frame.row);
  const double change = change_since(query, distances, frame.row);
  if (query.view.empty() ||
      change >= query.filter.settings.keyframe_change * distances.typical_distance) {
    const DescriptorRow view = distances.query.rows[frame.row];
    query.view.assign(view.begin(), view.end());
    advance_filter(query.filter, query.scores);
    follow_keyframe(query.track, query.filter, query_view(query, distances, frame.number, change));
    write_views(query);
  }
  const PathFrame path = path_at(query.track, query.filter.cells, frame.number);
  write_best(query, path);
  return {path.margin, path.off_map, path.rate, path.track};
}

}  // namespace

WindowStage filter_stage(const FrameDistances& distances, std::span<const size_t>,
                         const MatchSettings& settings) {
  const auto query = std::make_shared<FilteredQuery>(start_filtered(distances, settings));
  return
      [query](const FrameDistances& rows, const QueryFrame& frame, const StageConsumer& consume) {
        if (frame.in_a_row == 0 || query->filter.cells.places == 0) return;
        const PathReport report = add_frame(*query, rows, frame);
        std::vector<ScoreRow> row = whole_row(rows, 1, frame.number, query->row);
        for (ScoreRow& piece : row) piece.path = &report;
        if (!row.empty()) consume(0, row);
      };
}

}  // namespace vpr
