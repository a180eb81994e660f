#include "matching/match_filter.h"

#include <algorithm>
#include <cassert>

#include "base/parallel.h"

namespace vpr {
namespace {

constexpr size_t kFramesPerThread = 32768;  // below, a second thread costs more than it gives

// The scores of frames that are no view are computed, too: something may be learned from them.
void find_scores(FilteredQuery& query, const FrameDistances& distances, size_t frame) {
  const auto asked = static_cast<uint32_t>(frame);
  distances.start_row(frame);
  const size_t frames = distances.train_frames;
  const size_t parts = std::clamp<size_t>(frames / kFramesPerThread, 1, thread_count());
  const size_t part =
      (frames / parts + kStretchFrames) / kStretchFrames * kStretchFrames;  // covers all in parts
  const auto find = [&](size_t p) {
    const size_t first = std::min(p * part, frames);
    const size_t last = std::min(first + part, frames);
    if (first < last) distances.tile({&asked, 1}, first, last, query.scores.data() + first, 0);
  };
  if (parts == 1) return find(0);
  parallel_for(parts, Monitor{}, find);
}

bool shows_new_view(const FilteredQuery& query, const FrameDistances& distances, size_t frame) {
  const double least_change = query.filter.settings.view_change * distances.typical_distance;
  return !query.view || frame_distance(distances.query.rows, *query.view, frame) >= least_change;
}

void write_views(FilteredQuery& query) {
  const FilterCells& cells = query.filter.cells;
  for (const CellRun& run : cells.runs) {
    size_t frame = cells.frames[run.first];
    for (size_t cell = run.first; cell < run.first + run.count; ++cell) {
      const size_t end = view_end(cells, run, cell);
      const uint32_t value = query.filter.values[cell];
      for (; frame < end; ++frame) query.row[frame] = value;
    }
  }
}

// Of the best view, one frame is better than the others.
void write_best(FilteredQuery& query, const PathFrame& path) {
  const FilterCells& cells = query.filter.cells;
  const uint32_t value = query.filter.values[path.cell];
  const size_t end = view_end(cells, run_of(cells, path.cell), path.cell);
  std::fill(query.row.begin() + cells.frames[path.cell],
            query.row.begin() + static_cast<ptrdiff_t>(end), value + 1);
  query.row[path.frame] = value;
}

}  // namespace

FilteredQuery start_filtered(const FrameDistances& distances, const MatchSettings& settings) {
  assert(distances.is_in_order());
  FilteredQuery query;
  query.filter = start_filter(distances, settings.filter,
                              settings.filter.view_change * distances.typical_distance);
  query.track.kernels = settings.kernels;
  query.track.shared = settings.shared_places;
  query.scores.resize(distances.train_frames + kStretchFrames);
  query.row.resize(distances.train_frames);
  return query;
}

void forget_frames(FilteredQuery& query) {
  restart_filter(query.filter);
  query.track.views = 0;
  query.view.reset();
}

PathReport take_frame(FilteredQuery& query, const FrameDistances& distances, size_t frame) {
  const size_t number = query.passed + frame;
  find_scores(query, distances, frame);
  if (shows_new_view(query, distances, frame)) {
    query.view = frame;
    advance_filter(query.filter, query.scores);
    follow_view(query.track, query.filter, query.scores, number);
    write_views(query);
  }
  const PathFrame path = path_at(query.track, query.filter.cells, number);
  write_best(query, path);
  return {number, path.margin, path.nowhere, path.rate};
}

void match_filter(const FrameDistances& distances, const MatchSettings& settings,
                  const Monitor& monitor, const RowConsumer& consume) {
  assert(settings.window_length == 1);
  StepCounter counter(monitor, "match", distances.query_frames);
  FilteredQuery query = start_filtered(distances, settings);
  if (query.filter.cells.places == 0) return;
  for (const FrameRun& run : distances.query_runs) {
    forget_frames(query);
    for (size_t frame = run.first; frame < run.first + run.count; ++frame) {
      counter.add();
      const PathReport report = take_frame(query, distances, frame);
      if (settings.on_path) settings.on_path(report);
      emit_row(distances, 1, frame, 0, query.row, consume);
    }
  }
}

}  // namespace vpr
